// What the page was written with: parameters, lineage and, in a report, grown trees as in tree.json.

const page = JSON.parse(element("furrow-data").textContent);
/** The trees of the page, {name, made, colours, tree}: of a report one, of scenarios several, of the explorer none. */
const scenarios = page.scenarios.map((scenario, k) => ({ ...scenario, tree: k === 0 ? page.tree : page.others[k - 1] }));

/** Units of a lineage: L_h in µm and τ in minutes, where it gives them. */
const unitsOf = (lineage) => lineage.units ?? {};

/** The least of 1, 2, 5, 10, 20, … that is no less than a number. */
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].find((digit) => digit * decade >= least * (1 - 1e-9)) * decade;
  return Number(step.toPrecision(1));
}

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
    /** Letters of the longest name of a cell without daughters. */
    this.longest = this.nodes.reduce((most, { cell, daughters }) => (daughters.length ? most : Math.min(16, Math.max(most, cell.name.length))), 0);
    for (let k = this.nodes.length - 1; k >= 0; k--) {
      const node = this.nodes[k];
      node.below = node.daughters.reduce((sum, daughter) => sum + 1 + daughter.below, 0);
      node.foundersBelow = node.daughters.some((daughter) => daughter.isFounder || daughter.foundersBelow);
      /** The cell that divides last of all below it and itself. */
      node.last = node.daughters.reduce((last, daughter) => (last && last.division_min >= (daughter.last?.division_min ?? -Infinity) ? last : daughter.last), node.cell.division_min === undefined ? null : node.cell);
      node.folded = false;
    }
    /** Cells by generation, those that are folded away included. */
    this.counts = [];
    for (const { cell } of this.nodes) this.counts[cell.generation] = (this.counts[cell.generation] ?? 0) + 1;
    this.extrapolates = this.nodes.some(({ cell }) => cell.lifetime_extrapolated);
    /** Whether the cells have minutes: births and divisions in their order. */
    this.timed = this.root.cell.birth_min !== undefined;
    const sorted = (name) => this.nodes.map(({ cell }) => cell[name]).filter((min) => min !== undefined).sort((a, b) => a - b);
    this.births = this.timed ? sorted("birth_min") : [];
    this.divisions = this.timed ? sorted("division_min") : [];
    this.place();
  }

  /** The row of a minute: minutes take the height that generations have. */
  levelAt(min) {
    const span = this.latest - this.root.cell.birth_min;
    return span > 0 ? ((min - this.root.cell.birth_min) / span) * this.depth : 0;
  }

  /** Cells alive at a minute, those that are folded away included. */
  alive(min) {
    const before = (times) => times.reduce((count, time) => count + (time <= min), 0);
    return before(this.births) - before(this.divisions);
  }

  /** Round minutes, so far apart that they can be read where a row has these pixels. */
  minuteMarks(row) {
    const first = this.root.cell.birth_min;
    const perMinute = (this.depth * row) / Math.max(1e-9, this.latest - first);
    const step = Math.max(1, roundStep(30 / perMinute));
    const marks = [];
    for (let k = Math.ceil(first / step); k * step <= this.latest; k++) marks.push(k * step);
    return marks.map((min) => ({ level: this.levelAt(min), name: String(min).replace("-", "\u2212"), cells: this.alive(min) }));
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
        node.latest = node.cell.birth_min;
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
      node.latest = Math.max(...node.daughters.map((daughter) => daughter.latest));
    }
    this.columns = column;
    /** The last birth in view, in minutes. */
    this.latest = this.root.latest;
    this.shown = order;
    this.generations = [];
    for (const node of order) (this.generations[node.cell.generation] ??= []).push(node);
    for (const row of this.generations) {
      row.sort((a, b) => a.x - b.x);
      row.forEach((node, place) => (node.place = place));
    }
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

/** What the poles are called, u = 1 and u = 0; the film has them on the left and on the right. */
function poles(lineage) {
  const [first, second] = lineage.naming ?? ["a", "p"];
  return first === "a" && second === "p" ? ["anterior", "posterior"] : [`daughter ${first}`, `daughter ${second}`];
}


/** A length in Lₕ, with µm behind it where the lineage file says how long Lₕ is. */
function lengthText(value, { length_um }, digits = 4) {
  const natural = number(value, digits);
  return length_um ? `${natural} Lₕ (${(value * length_um).toFixed(2)} µm)` : `${natural} Lₕ`;
}

function timeText(value, { time_min }) {
  const natural = value >= 100 ? value.toFixed(1) : value.toFixed(3);
  return time_min ? `${natural} τ (${(value * time_min).toFixed(2)} min)` : `${natural} τ`;
}

/** A text in which numbers with many digits are rounded to six of them. */
const rounded = (text) => text.replace(/\d+\.\d+/g, (digits) => (digits.length > 8 ? String(Number(Number(digits).toPrecision(6))) : digits));

/** When a cell is born and divides, where its lineage has a clock. */
function lifeText({ birth_min, division_min, lifetime_extrapolated }) {
  if (birth_min === undefined) return "";
  const divides = division_min === undefined ? "" : `, divides at ${number(division_min, 1)} min`;
  return `; born at ${number(birth_min, 1)} min${divides}${lifetime_extrapolated ? " (extrapolated)" : ""}`;
}

/** The second neck of a cell that falls into three parts. */
function neckRows({ second_neck: neck }) {
  return neck ? [["second neck at u", `${number(neck.u, 4)}: the cell falls into three parts`]] : [];
}

/** The regulator φ of a division, or of a cell in a tree, as rows of a table. */
function phiRows({ phi, chi }) {
  return phi == null ? [] : [[chi == null ? "regulator φ at u = 0.5" : "regulator φ at the furrow", number(phi, 4)]];
}

/** Settings of a cell and its numerics by section, as a configuration file has them. */
function sections(cell, numerics) {
  const { epsilon, xi_s, r0, material, shell } = cell;
  return { physics: { ...material, ...shell, r0, epsilon, xi_s }, numerics };
}

/** Options of the command line for what differs from the preset's cell and numerics; `given` stands by itself. */
function settingOptions(cell, numerics, given) {
  const usual = sections(page.preset.cell, page.preset.numerics);
  // The aspect ratio of the table may be set after it.
  const options = cell.shell_profile ? [`--set shell_profile=${quoted(tableOf(cell))}`] : [];
  for (const [section, values] of Object.entries(sections(cell, numerics))) {
    for (const [name, value] of Object.entries(values)) {
      if (!given.includes(name) && value !== usual[section][name]) options.push(`--set ${name}=${value}`);
    }
  }
  return options;
}

/** The file of a cell's profile, which bears the name of its table. */
const tableOf = ({ shell_profile }) => `${shell_profile.name}.csv`;

/** A text as one word of a shell. */
const quoted = (text) => (/^[\w.,:=+@%/-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** A configuration file with these settings; `notes` are comments. */
function configuration(cell, numerics, notes) {
  const part = ([section, values]) => `    ${section}: (\n${Object.entries(values).map(([name, value]) => `        ${name}: ${value},\n`).join("")}    ),\n`;
  const table = cell.shell_profile ? `    shell_profile: ${JSON.stringify(tableOf(cell))},\n` : "";
  return `${notes.map((note) => `// ${note}\n`).join("")}Config(\n${table}${Object.entries(sections(cell, numerics)).map(part).join("")})\n`;
}

/** Why a cell has no daughters, in words. */
function endText(ended) {
  switch (ended?.reason) {
    case undefined: return null;
    case "at_rest": return "came to rest undivided, in a stable shape";
    case "below_pitchfork": return `below the pitchfork boundary R0 = ${number(ended.r0_c)}`;
    case "below_cued_fold": return `below the fold of the cued branch, R0 = ${number(ended.r0)}`;
    case "below_bent_boundary": return `below the boundary of bent states R0 = ${number(ended.r0_c)}`;
    case "undecided": return `undecided: ${ended.why}`;
    case "dies": return "dies, by the lineage file";
    case "most_rounds": return `ends after its founder's ${ended.most_rounds} rounds`;
    case "max_depth": return `stopped by the limit of ${ended.max_depth} generations`;
    case "max_cells": return `stopped by the limit of ${ended.max_cells} cells`;
    default: return ended.reason;
  }
}

/** What the solver needs to compute the division of a cell of a tree. */
function divisionOf(head, node) {
  const { cell, numerics, seed, r0_step } = head;
  const founder = head.lineage.founders[node.founder];
  const physics = { ...founder.physics, ...node.cell.physics };
  return { cell: { ...inShell(cell, founder), r0: node.cell.r0, cue: node.cell.cue }, numerics, seed, r0_step, physics };
}

/** A cell in the shell of its founder, who may have none of its own. A table has an aspect ratio. */
function inShell(cell, { shell_profile: own }) {
  if (own === undefined) return cell;
  const { shell_profile, ...bare } = cell;
  return own === "ellipsoid" ? bare : { ...bare, shell_profile: own, shell: { ...cell.shell, aspect: own.aspect } };
}
