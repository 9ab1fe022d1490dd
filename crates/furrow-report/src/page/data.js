// What the page was written with: parameters, lineage and, in a report, the grown tree as in tree.json.

const page = JSON.parse(element("furrow-data").textContent);
const units = page.head.lineage.units ?? {};

/** The cells of a tree.json as nodes that know mother, daughters, and their place. */
function nodesOf(tree) {
  const byName = new Map();
  const founders = new Map(tree.lineage.founders.map((founder, k) => [founder.name, k]));
  return tree.cells.map((cell, index) => {
    const mother = cell.mother === null ? null : byName.get(cell.mother);
    const node = { cell, index, mother, daughters: [], founder: founders.get(cell.founder), isFounder: cell.name === cell.founder };
    byName.set(cell.name, node);
    // Breadth first, the anterior daughter before the posterior.
    mother?.daughters.push(node);
    return node;
  });
}

/** A founder tree: what it was grown with, its nodes, and what is folded away. */
class Tree {
  constructor(tree) {
    this.head = tree;
    this.nodes = nodesOf(tree);
    this.root = this.nodes[0];
    this.byName = new Map(this.nodes.map((node) => [node.cell.name, node]));
    this.largest = this.root.cell.r0;
    for (let k = this.nodes.length - 1; k >= 0; k--) {
      const node = this.nodes[k];
      node.below = node.daughters.reduce((sum, daughter) => sum + 1 + daughter.below, 0);
      node.folded = false;
    }
    this.place();
  }

  /** Gives every visible node its column, half way between its daughters, and the span of columns below it. */
  place() {
    let column = 0;
    const order = [];
    const stack = [this.root];
    this.depth = 0;
    while (stack.length) {
      const node = stack.pop();
      order.push(node);
      this.depth = Math.max(this.depth, node.cell.generation);
      if (node.folded || !node.daughters.length) {
        node.x = node.from = node.to = column++;
        node.deepest = node.cell.generation;
      } else {
        for (let k = node.daughters.length - 1; k >= 0; k--) stack.push(node.daughters[k]);
      }
    }
    for (let k = order.length - 1; k >= 0; k--) {
      const node = order[k];
      if (node.folded || !node.daughters.length) continue;
      const [first, last] = [node.daughters[0], node.daughters[node.daughters.length - 1]];
      node.x = (first.x + last.x) / 2;
      [node.from, node.to] = [first.from, last.to];
      node.deepest = Math.max(...node.daughters.map((daughter) => daughter.deepest));
    }
    this.columns = column;
    this.shown = order;
    this.generations = [];
    for (const node of order) (this.generations[node.cell.generation] ??= []).push(node);
    for (const row of this.generations) row.sort((a, b) => a.x - b.x);
  }

  fold(node, folded) {
    if (!node.daughters.length || node.folded === folded) return;
    node.folded = folded;
    this.place();
  }

  /** Folds every cell of a generation that is far enough from the first. */
  foldFrom(generation) {
    for (const node of this.nodes) node.folded = node.daughters.length > 0 && node.cell.generation >= generation;
    this.place();
  }

  /** Unfolds all that hides a node. */
  reveal(node) {
    let changed = false;
    for (let above = node.mother; above; above = above.mother) {
      changed ||= above.folded;
      above.folded = false;
    }
    if (changed) this.place();
  }
}

const number = (value, digits = 4) => (value === null || value === undefined ? "–" : value.toFixed(digits));

/** A length in L_h, with µm behind it where the lineage file says how long L_h is. */
function lengthText(value) {
  const natural = number(value);
  return units.length_um ? `${natural} L_h (${(value * units.length_um).toFixed(2)} µm)` : `${natural} L_h`;
}

function timeText(value) {
  const natural = value >= 100 ? value.toFixed(1) : value.toFixed(3);
  return units.time_min ? `${natural} τ (${(value * units.time_min).toFixed(2)} min)` : `${natural} τ`;
}

/** A cue of a file as the command line takes it: "none", or terms joined by +. */
function cueText(cue) {
  if (cue === "none") return "none";
  const [[name, value]] = Object.entries(cue);
  if (name === "sum") return value.map(cueText).join("+");
  const parts = [];
  if ("u0" in value) parts.push(`u0=${value.u0}`);
  if ("omega" in value) parts.push(`omega=${value.omega}`);
  if ("omega_length" in value) parts.push(`omega=${value.omega_length}Lh`);
  parts.push(`amplitude=${value.amplitude}`);
  return `${name}:${value.profile ?? "band"},${parts.join(",")}`;
}

/** Why a cell has no daughters, in words. */
function endText(ended) {
  switch (ended?.reason) {
    case undefined: return null;
    case "at_rest": return "came to rest undivided, in a stable shape";
    case "below_pitchfork": return `below the pitchfork boundary R0 = ${number(ended.r0_c)}`;
    case "below_cued_fold": return `below the fold of the cued branch, R0 = ${number(ended.r0)}`;
    case "undecided": return `undecided: ${ended.why}`;
    case "max_depth": return `stopped by the limit of ${ended.max_depth} generations`;
    case "max_cells": return `stopped by the limit of ${ended.max_cells} cells`;
    default: return ended.reason;
  }
}

/** What the solver needs to compute the division of a cell of a tree. */
function divisionOf(head, node) {
  const { cell, numerics, seed, r0_step } = head;
  const physics = { ...head.lineage.founders[node.founder].physics, ...node.cell.physics };
  return { cell: { ...cell, r0: node.cell.r0, cue: node.cell.cue }, numerics, seed, r0_step, physics };
}
