// What the reader takes along: pictures, trees and settings.

/** Hands the reader a file. */
function save(name, content, type) {
  const address = URL.createObjectURL(new Blob([content], { type }));
  const link = Object.assign(document.createElement("a"), { href: address, download: name, hidden: true });
  document.body.append(link);
  link.click();
  link.remove();
  // The browser reads it after this.
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}

/** Saves what `draw(canvas, [width, height, ratio])` draws, as large as it is shown and three times as fine. */
function savePicture(name, draw, shown) {
  const canvas = document.createElement("canvas");
  draw(canvas, [shown.clientWidth, shown.clientHeight, 3]);
  canvas.toBlob((content) => save(name, content, "image/png"));
}

/** The buttons above the lineage; `shown()` gives the tree in view and the name of its files. */
function setUpSaving(shown, canSolve) {
  const named = (ending) => `${shown().name.replace(/[^\w.-]+/g, "-")}.${ending}`;
  element("save-picture").addEventListener("click", () => lineage.picture(3).toBlob((content) => save(named("png"), content, "image/png")));
  element("save-json").addEventListener("click", () => save(named("json"), `${JSON.stringify(shown().tree, null, 2)}\n`, "application/json"));
  element("save-settings").addEventListener("click", () => save(named("ron"), treeSettings(shown().tree), "text/plain"));
  element("save-newick").hidden = !canSolve;
  element("save-newick").addEventListener("click", async () => {
    // The solver has the same writer as the command line.
    const writer = new Solver();
    try {
      save(named("nwk"), (await writer.ask("newick", shown().tree)).answer, "text/plain");
    } catch (error) {
      element("said").textContent = `The tree could not be written as Newick: ${error.message}`;
    }
    writer.stop();
  });
}

/** The settings of a tree as a configuration file. Its lineage is in tree.json. */
function treeSettings({ cell, numerics, seed, lineage: of }) {
  return configuration(cell, numerics, [`Settings of the tree of ${of.name}.`, `  furrow tree --config FILE.ron --r0 ${cell.r0} --seed ${seed}`, "The founders and their cues are in its tree.json."]);
}
