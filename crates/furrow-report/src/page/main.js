// Puts the page together.

/** An element with a text in it. */
function make(kind, text) {
  const made = document.createElement(kind);
  made.textContent = text;
  return made;
}

let lineage = null;

/** The tree's canvas with its search box and buttons. */
function setUpLineage(panel) {
  lineage = new LineageView(element("lineage"), {
    // A division takes a blink: it is there as soon as its cell is, half way through, and played when the cell is opened.
    onSelect: (node) => {
      panel.show(lineage.tree.head, node);
      panel.open({ playing: false });
    },
    onOpen: () => panel.open(),
  });
  const middle = () => [lineage.width / 2, lineage.height / 2];
  element("zoom-in").addEventListener("click", () => lineage.zoomAt(1.6, ...middle()));
  element("zoom-out").addEventListener("click", () => lineage.zoomAt(1 / 1.6, ...middle()));
  element("zoom-fit").addEventListener("click", () => lineage.fit());
  element("fold").addEventListener("click", () => {
    if (!lineage.selected) return;
    lineage.toggle(lineage.selected);
  });
  element("unfold").addEventListener("click", () => {
    lineage.tree.foldFrom(Infinity);
    lineage.draw();
  });
  setUpSearch();
}

function setUpSearch() {
  const box = element("search");
  const count = element("search-count");
  let matches = [];
  let place = -1;
  const told = () => {
    count.textContent = box.value === "" ? "" : matches.length === 0 ? "none" : `${Math.max(0, place) + 1} of ${matches.length}`;
  };
  const go = (step) => {
    if (!matches.length) return;
    place = (place + step + matches.length) % matches.length;
    lineage.tree.reveal(matches[place]);
    lineage.approach(matches[place]);
    told();
  };
  box.addEventListener("input", () => {
    const wanted = box.value.trim().toLowerCase();
    const names = wanted ? lineage.tree.nodes.filter((node) => node.cell.name.toLowerCase().startsWith(wanted)) : [];
    matches = names.sort((a, b) => a.cell.name.length - b.cell.name.length || a.index - b.index);
    place = -1;
    lineage.found = new Set(matches);
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

function main() {
  const why = hindrance();
  element("live").hidden = element("theme").hidden = false;
  const solver = why ? null : new Solver();
  const panel = new CellPanel(solver, (node) => {
    lineage.tree.reveal(node);
    lineage.select(node);
    panel.open();
  }, (node) => {
    const physics = { ...lineage.tree.head.lineage.founders[node.founder].physics, ...node.cell.physics };
    whatIf.begin({ ...lineage.tree.head.cell, ...pick(physics, ["epsilon", "xi_s"]), r0: node.cell.r0, cue: node.cell.cue, name: node.cell.name, physics });
    element("what-if").scrollIntoView({ behavior: "smooth" });
  });
  let whatIf = null;
  const shown = (tree, title) => {
    panel.close();
    element("lineage-part").hidden = false;
    element("lineage-title").textContent = title ?? "";
    lineage.resize();
    lineage.show(new Tree(tree));
    element("search").value = "";
    element("search").dispatchEvent(new Event("input"));
    lineage.select(lineage.tree.root);
  };
  setUpLineage(panel);
  if (why) tellWithout(why);
  else {
    // Films and sliders share one worker, which is warm sooner; edges, which take longer, have their own.
    whatIf = new WhatIf(solver, new Solver());
    new Regrow(whatIf, shown, page.tree);
    const first = page.tree?.cells[0];
    whatIf.begin({ ...page.head.cell, r0: first?.r0 ?? page.head.cell.r0, cue: first?.cue ?? "none", name: first?.name });
    solverModule().catch((error) => tellWithout(String(error)));
  }
  if (page.tree) shown(page.tree, null);
  themeSwitch(element("theme"), () => {
    lineage.draw();
    panel.player.draw();
    whatIf?.draw();
    whatIf?.diagram.draw();
  });
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

function pick(object, names) {
  return Object.fromEntries(names.filter((name) => name in object).map((name) => [name, object[name]]));
}

main();
