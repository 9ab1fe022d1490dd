// Puts the page together.

/** An element with a text in it. */
function make(kind, text) {
  const made = document.createElement(kind);
  made.textContent = text;
  return made;
}

let lineage = null;

/** The tree's canvas with its search box and buttons. */
function setUpLineage(panel, { spreadOf, onSelect }) {
  lineage = new LineageWalk(element("lineage"), {
    // A division takes a blink: it is there as soon as its cell is, half way through, and played when the cell is opened.
    onSelect: (node) => {
      panel.show(lineage.tree.head, node, spreadOf(node));
      panel.open({ playing: false });
      onSelect(node);
    },
    onOpen: () => {
      panel.open();
      panel.comeIntoView();
    },
  });
  const middle = () => [lineage.width / 2, lineage.height / 2];
  element("zoom-in").addEventListener("click", () => lineage.zoomAt(1.6, ...middle()));
  element("zoom-out").addEventListener("click", () => lineage.zoomAt(1 / 1.6, ...middle()));
  element("zoom-fit").addEventListener("click", () => lineage.fit());
  element("fold").addEventListener("click", () => {
    if (lineage.selected) lineage.toggle(lineage.selected);
  });
  element("unfold").addEventListener("click", () => lineage.unfold());
  element("by-generation").addEventListener("click", () => drawBy(false));
  element("by-minute").addEventListener("click", () => drawBy(true));
  setUpSearch();
}

/** Draws cells at their births in minutes, or at their generations; without a clock there are only these. */
function drawBy(minutes) {
  lineage.minutes = minutes && lineage.tree.timed;
  element("time-axis").hidden = !lineage.tree.timed;
  element("by-generation").setAttribute("aria-pressed", String(!lineage.minutes));
  element("by-minute").setAttribute("aria-pressed", String(lineage.minutes));
  element("extrapolated").hidden = !(lineage.minutes && lineage.tree.extrapolates);
  lineage.fit();
}

function setUpSearch() {
  const box = element("search");
  const count = element("search-count");
  let matches = [];
  let place = -1;
  /** What was in view before the first match was gone to, and what is since. */
  let before = null;
  let after = null;
  const told = () => {
    count.textContent = box.value === "" ? "" : matches.length === 0 ? "none" : `${Math.max(0, place) + 1} of ${matches.length}`;
  };
  const go = (step) => {
    if (!matches.length) return;
    before ??= lineage.view();
    place = (place + step + matches.length) % matches.length;
    lineage.tree.reveal(matches[place]);
    lineage.approach(matches[place]);
    after = lineage.view();
    told();
  };
  /** When the search is over the view is what it was, unless the reader has moved it meanwhile. */
  const over = () => {
    if (before && JSON.stringify(after) === JSON.stringify(lineage.view())) lineage.restore(before);
    before = after = null;
  };
  box.addEventListener("input", () => {
    const wanted = box.value.trim().toLowerCase();
    const names = wanted ? lineage.tree.nodes.filter((node) => node.cell.name.toLowerCase().startsWith(wanted)) : [];
    matches = names.sort((a, b) => a.cell.name.length - b.cell.name.length || a.index - b.index);
    place = -1;
    lineage.found = new Set(matches);
    if (!wanted) over();
    lineage.draw();
    told();
  });
  box.addEventListener("keydown", (event) => {
    if (event.key === "Enter") {
      event.preventDefault();
      go(event.shiftKey ? -1 : 1);
    } else if (event.key === "Escape") {
      box.value = "";
      box.dispatchEvent(new Event("input"));
      lineage.canvas.focus();
      event.stopPropagation();
    }
  });
  element("search-next").addEventListener("click", () => go(1));
}

/** A tree comes into view: one of the page, or one that was grown in it. */
class Shown {
  constructor(panel) {
    this.panel = panel;
    this.place = 0;
    this.grown = null;
    this.overview = null;
    this.regrow = null;
    /** What the page says of its own tree. */
    this.written = { summary: element("summary")?.innerHTML, below: element("of-tree").innerHTML };
  }

  /** The tree in view, and a name for its files. */
  get file() {
    const { name } = scenarios[this.place] ?? { name: "tree" };
    return this.grown ? { tree: this.grown, name: `${name || "tree"}-grown` } : { tree: scenarios[this.place].tree, name: name || "tree" };
  }

  /** What a founder is over seeds, where that is known. */
  spread(node) {
    const rows = this.grown ? null : scenarios[this.place]?.spread;
    return (node.isFounder && rows?.find((row) => row.name === node.cell.name)) || null;
  }

  /** One of the page's trees, with a cell of it selected. */
  go(place, name = null) {
    const scenario = scenarios[place];
    if (place !== this.place || this.grown || !lineage.tree) {
      Object.assign(this, { place, grown: null });
      this.put(scenario.tree, scenario.colours, scenarios.length > 1 ? `${place + 1} ${scenario.name}: ${scenario.tree.cells.length} cells` : "");
      this.regrow?.from(scenario.tree, scenario.tree, scenario.name || "the report's tree");
    }
    const node = lineage.tree.byName.get(name) ?? lineage.tree.root;
    lineage.select(node);
    if (name) {
      this.panel.open();
      this.panel.comeIntoView();
    }
  }

  /** A tree that was grown in the page from one of its own, and what there is to say of it. */
  grew(tree, title, told) {
    this.grown = tree;
    this.put(tree, scenarios[this.place]?.colours ?? page.colours, title, told);
    element("summary")?.querySelector("p").prepend("Grown here: ");
    lineage.select(lineage.tree.root);
  }

  put(tree, colours, title, { summary, below } = this.written) {
    element("lineage-part").hidden = false;
    element("lineage-title").textContent = title;
    lineage.measure();
    lineage.show(new Tree(tree), colours);
    drawBy(lineage.minutes);
    element("search").value = "";
    element("search").dispatchEvent(new Event("input"));
    if (element("summary")) element("summary").innerHTML = summary;
    element("of-tree").innerHTML = below;
    watchTables(element("of-tree"));
    this.overview?.mark(this.grown ? -1 : this.place);
  }
}

function main() {
  const why = hindrance();
  element("live").hidden = element("theme").hidden = false;
  let whatIf = null;
  const panel = new CellPanel(why ? null : new Solver(), {
    onSize: () => lineage.measure(),
    onGo: (node) => {
      lineage.tree.reveal(node);
      lineage.select(node);
      panel.open();
    },
    onExplore: (node) => {
      const { head } = lineage.tree;
      const founder = head.lineage.founders[node.founder];
      const physics = { ...founder.physics, ...node.cell.physics };
      whatIf.begin({ ...head.cell, ...pick(physics, ["epsilon", "xi_s"]), head, founder, r0: node.cell.r0, cue: node.cell.cue, name: node.cell.name, physics });
      element("what-if").scrollIntoView({ behavior: "smooth" });
    },
  });
  const shown = new Shown(panel);
  setUpLineage(panel, {
    spreadOf: (node) => shown.spread(node),
    onSelect: (node) => shown.overview?.mark(shown.grown ? -1 : shown.place, node.cell.name),
  });
  setUpSaving(() => shown.file, !why);
  if (why) tellWithout(why);
  else {
    // A solver that is given up takes all of its work with it: films, sliders and edges have one each.
    whatIf = new WhatIf(new Solver(), new Solver());
    shown.regrow = new Regrow(whatIf, { onTree: (...grown) => shown.grew(...grown), onBack: () => shown.go(shown.place) });
    const first = page.tree?.cells[0];
    whatIf.begin({ ...page.head.cell, r0: first?.r0 ?? page.head.cell.r0, cue: first?.cue ?? "none", name: first?.name });
    solverModule().catch((error) => tellWithout(String(error)));
  }
  if (scenarios.length > 1) shown.overview = new Overview(element("overview"), (place, name) => shown.go(place, name));
  if (page.tree) shown.go(0);
  themeSwitch(element("theme"), () => {
    lineage.draw();
    shown.overview?.draw();
    panel.player.draw();
    whatIf?.draw();
    whatIf?.diagram.draw();
  });
  watchTables(document);
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !element("cell-panel").hidden) panel.close();
  });
  document.documentElement.dataset.ready = "true";
}

/** Says why nothing can be computed here; all that stands in the page is still shown. */
function tellWithout(why) {
  element("without-solver").hidden = false;
  element("without-solver").textContent = `This browser cannot run the solver: ${why}. What was computed before is all here; divisions are not played and nothing can be changed.`;
  for (const part of document.querySelectorAll(".needs-solver")) part.hidden = true;
}

/** A table that is cut at the edge of the screen says so. */
function watchTables(within) {
  for (const frame of within.querySelectorAll(".wrap")) {
    const table = frame.querySelector("table");
    const told = () => frame.classList.toggle("cut", frame.scrollWidth > frame.clientWidth + 1);
    const watch = new ResizeObserver(told);
    watch.observe(frame);
    if (table) watch.observe(table);
  }
}

function pick(object, names) {
  return Object.fromEntries(names.filter((name) => name in object).map((name) => [name, object[name]]));
}

main();
