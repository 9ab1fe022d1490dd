// Opens a report and an explorer from disk in a headless Chromium and does with them what a reader does.
//
//   node report.mjs CHROMIUM EXPECTED.json [FOLDER for screenshots]
//
// EXPECTED.json is what the command line says of the same things; see tests/command/page.rs. Prints measures, ends with 1 if anything differs.

import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { check, complaints, data, expected, frame, measures, near, place, run, shot, shots, slide, text, type } from "./reader.mjs";

/** Where the first full disc of AB's blue is on the screen, by the pixels of the drawing: nothing is asked of the page. */
async function drawnAB(page) {
  const found = await page.worth(`(() => {
    const canvas = document.getElementById("lineage");
    canvas.scrollIntoView({ block: "center" });
    const { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
    const { left, top, width: wide, height: tall } = canvas.getBoundingClientRect();
    for (let y = 0; y < height; y++) for (let x = 0, run = 0; x < width; x++) {
      const at = 4 * (y * width + x);
      run = data[at] === 0x2f && data[at + 1] === 0x6d && data[at + 2] === 0xb5 ? run + 1 : 0;
      if (run === 14) return [left + ((x - 7) * wide) / width, top + ((y + 3) * tall) / height];
    }
    return null;
  })()`);
  check("AB is drawn", found !== null, found);
  return found ?? [0, 0];
}

/** A click on the first cell: its division is computed, played, and is that of the table. */
async function divides(page) {
  await page.click(...(await place(page, "P0")));
  await page.until(`document.getElementById("play").textContent === "Pause"`);
  const early = Number(await page.worth(`document.getElementById("scrub").value`));
  await page.until(`Number(document.getElementById("scrub").value) > ${early} + 0.1`);
  if (shots) {
    await page.until(`Number(document.getElementById("scrub").value) > 0.72`);
    await shot(page, "mid-division", false);
  }
  const film = await data(page, "film-state");
  check("P0 divides as in the table", film.cell === "P0" && film.outcome === expected.p0.outcome && near(Number(film.chi), expected.p0.chi, 1e-6), film);
  check("its film has frames", Number(film.frames) > 20, film.frames);
  const shown = await page.worth(`document.getElementById("cell-numbers").innerText`);
  check("its numbers are shown", shown.includes(expected.p0.chi.toFixed(6)), shown);
}

/** A slider that is moved gives what `furrow divide` says. */
async function slides(page) {
  const before = await data(page, "what-if-result");
  check("the sliders begin at P0", near(Number(before.chi), expected.p0.chi, 1e-6), before);
  for (const { epsilon, outcome, chi } of expected.sliders) {
    const found = await slide(page, "epsilon", epsilon);
    check(`ε = ${epsilon}`, found.outcome === outcome && (chi === null ? found.chi === "" : near(Number(found.chi), chi, 1e-6)), found);
  }
  const took = [];
  for (let epsilon = 0.6; epsilon < 0.9; epsilon += 0.02) took.push(Number((await slide(page, "epsilon", epsilon.toFixed(3))).took));
  took.sort((a, b) => a - b);
  measures.slider_ms = { median: Math.round(took[took.length >> 1]), most: Math.round(took[took.length - 1]) };
  await slide(page, "epsilon", 0.87);
}

/** A cue as text, here one with a regulator, gives what `furrow divide --cue` says, and a slider takes its place again. */
async function regulates(page) {
  const begun = await page.worth(`document.getElementById("cue-text").value`);
  const write = async (cue) => {
    await page.worth(`(() => { const t = document.getElementById("cue-text"); t.value = ${JSON.stringify(cue)}; t.dispatchEvent(new Event("input", { bubbles: true })); t.dispatchEvent(new Event("change", { bubbles: true })); })()`);
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    return data(page, "what-if-result");
  };
  const { cue, outcome, chi, phi } = expected.regulator;
  const found = await write(cue);
  check("a regulator divides as on the command line", found.outcome === outcome && near(Number(found.chi), chi, 1e-6), found);
  const [numbers, shows, command] = [await text(page, "what-if-numbers"), await text(page, "what-if-shows"), await text(page, "command")];
  check("φ at the furrow is shown", numbers.includes(`regulator φ at the furrow${phi.toFixed(4)}`), numbers);
  check("the colours of φ are explained", shows.includes("The band is the regulator φ: orange above 0, to "), shows);
  check("its command line has the cue", command.includes(cue), command);
  await shot(page, "what-if-regulator");
  const refused = await write(cue.replace("diffusion=1", "diffusion=0.01"));
  const why = await text(page, "what-if-numbers");
  check("a regulator that cannot be resolved is refused", refused.outcome === "refused" && why.startsWith("because--cue: regulator.diffusion = 0.01: must be from 0.05"), why);
  await slide(page, "amplitude", 0.1);
  check("a slider of the cue takes the place of the text", begun === "" && (await page.worth(`document.getElementById("cue-text").value`)) === "", begun);
}

/** Divisions in the page, one after another on a worker that is warm. */
async function times(page) {
  const took = [];
  for (let k = 0; k < 8; k++) {
    await page.worth(`(() => { document.getElementById("lineage").focus(); document.getElementById("film-state").dataset.took = ""; })()`);
    await page.key(k % 2 ? "ArrowUp" : "ArrowDown");
    await page.key("Enter");
    await page.until(`document.getElementById("film-state").dataset.took`);
    if (k % 2) took.push(Number((await data(page, "film-state")).took));
  }
  took.sort((a, b) => a - b);
  measures.division_ms = { median: Math.round(took[took.length >> 1]), least: Math.round(took[0]) };
}

/** The tree grown without a cue has the counts of `furrow tree --cue none`. */
async function regrows(page) {
  await page.worth(`document.getElementById("regrow-cue").value = "none"`);
  await page.clickOn("#regrow");
  await page.until(`["done", "failed"].includes(document.getElementById("regrow-state").dataset.state)`);
  const { state, cells, founders, seconds } = await data(page, "regrow-state");
  check("the tree is grown", state === "done" && Number(cells) === expected.none.cells, { state, cells });
  if (state !== "done") return;
  const counts = (rows) => rows.map(({ name, outcome, rounds: { min, mean, max, full_doublings, terminal } }) => [name, outcome, min, mean, max, full_doublings, terminal].join(" ")).join("; ");
  check("its founders have the rounds of the command line", counts(JSON.parse(founders)) === counts(expected.none.founders), counts(JSON.parse(founders)));
  measures.tree_s = Number(Number(seconds).toFixed(2));
}

/** After "Grow" with a panel open the drawing fits its place, a click meets what is drawn there, and the header counts the new cells. */
async function growsBesideThePanel(page) {
  const header = await text(page, "summary");
  await page.click(...(await place(page, "P0")));
  await regrows(page);
  await frame(page);
  const [drawn, shown] = await page.worth(`(() => { const c = document.getElementById("lineage"); return [c.width, c.clientWidth]; })()`);
  check("the drawing is as wide as its place", drawn === shown, [drawn, shown]);
  await page.click(...(await drawnAB(page)));
  check("a click on AB as drawn selects AB", (await text(page, "cell-name")) === "AB", await text(page, "cell-name"));
  const grown = await text(page, "summary");
  check("the header counts the grown cells", grown.includes(`: ${expected.none.cells} cells `), grown);
  await page.clickOn("#regrow-back");
  check("the header is the report's again", (await text(page, "summary")) === header, await text(page, "summary"));
}

/** What `furrow divide` refuses is refused in its words, with nothing of the last cell beside it. */
async function refuses(page) {
  for (const [quantity, value, usual, why] of expected.refusals) {
    await type(page, quantity, value);
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    const found = await data(page, "what-if-result");
    const said = await text(page, "what-if-numbers");
    check(`${quantity} = ${value} is refused`, found.outcome === "refused" && said === `because${why}`, [found, said]);
    const left = [await text(page, "command"), await text(page, "what-if-shows"), await page.worth(`document.getElementById("what-if-command").hidden`)];
    check("the last cell's command line is gone", left[0] === "" && left[1] === "" && left[2], left);
    await type(page, quantity, usual);
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    check("and is back with an answer", (await text(page, "command")).startsWith("furrow divide --r0"), await text(page, "command"));
  }
}

/** A long computation shows as one, and is given up when the reader goes on. */
async function waits(page) {
  await page.worth(`(() => { const r = document.getElementById("what-if-result"); globalThis.told = []; new MutationObserver(() => told.push(r.dataset.r0)).observe(r, { attributes: true, attributeFilter: ["data-r0"] }); })()`);
  const before = (await data(page, "what-if-result")).chi;
  await type(page, "r0", 99);
  await page.until(`document.getElementById("outcome").textContent.startsWith("computing")`);
  const found = [await data(page, "what-if-result"), Number(await page.worth(`getComputedStyle(document.getElementById("what-if-numbers")).opacity`))];
  check("the last answer does not stand as this one's", found[0].state === "computing" && found[0].chi === before && found[1] < 0.3, found);
  await type(page, "r0", 2.5);
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  const told = await page.worth("told");
  check("what nobody waits for is given up", !told.includes("99") && told.at(-1) === "2.5", told);
  check("the answer stands clearly", (await page.worth(`getComputedStyle(document.getElementById("what-if-numbers")).opacity`)) === "1", "faint");
  await page.clickOn("#what-if-reset");
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
}

/** Zooming brings up names; searching and folding leave the view where it was. */
async function staysInView(page) {
  const names = () => page.worth(`Number(document.getElementById("lineage").dataset.names)`);
  await page.worth(`document.getElementById("lineage").focus()`);
  await page.key("0");
  await frame(page);
  const [few, before] = [await names(), await place(page, "AB")];
  const search = (name) => page.worth(`(() => { const s = document.getElementById("search"); s.value = ${JSON.stringify(name)}; s.dispatchEvent(new Event("input")); s.focus(); })()`);
  await search("ABal");
  await page.key("Enter");
  await frame(page);
  const many = await names();
  check("zooming brings up names", many > few + 8, [few, many]);
  await page.worth(`document.getElementById("lineage").focus()`);
  const [x, y] = await place(page, "ABal", [42, 600]);
  await page.key(" ");
  await frame(page);
  const [u, v] = await place(page, "ABal", [42, 600]);
  check("a folded cell stays where it is", near(x, u, 16) && near(y, v, 16), [x, y, u, v]);
  await page.key(" ");
  await search("ems");
  await page.key("Enter");
  await page.key("Escape");
  await page.clickOn("#zoom-fit");
  await search("ems");
  await page.key("Enter");
  await frame(page);
  await page.key("Escape");
  await frame(page);
  const after = await place(page, "AB");
  check("the view is back after a search", near(before[0], after[0], 9) && near(before[1], after[1], 9), [before, after]);
}

/** Buttons save what the command line writes. */
async function saves(page) {
  fs.mkdirSync(expected.saves, { recursive: true });
  await page.browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: expected.saves });
  const file = (name) => path.join(expected.saves, name);
  const saved = async (button, name) => {
    await page.worth(`document.getElementById(${JSON.stringify(button)}).click()`);
    for (let tries = 0; !fs.existsSync(file(name)) || fs.statSync(file(name)).size === 0; tries++) {
      if (tries === 600) throw new Error(`${name} is not saved`);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    return fs.readFileSync(file(name));
  };
  check("Newick is that of the command line", (await saved("save-newick", "tree.nwk")).toString() === expected.newick, "another");
  check("tree.json is the tree", JSON.parse(await saved("save-json", "tree.json")).cells.length === expected.cells, "another");
  for (const [button, name] of [["save-picture", "tree.png"], ["what-if-picture", "furrow-cell.png"]]) {
    check(`${name} is a picture`, (await saved(button, name)).subarray(1, 4).toString() === "PNG", name);
  }
  await saved("save-settings", "tree.ron");
  await slide(page, "epsilon", 0.9);
  await saved("what-if-settings", "furrow.ron");
}

/** Scenarios: every tree can be opened, by a cell of it, its name, or its column. */
async function scenarios(browser) {
  const address = pathToFileURL(expected.scenarios.page).href;
  for (const [width, dark] of [[1400, false], [390, true]]) {
    const page = await browser.open(address, { width, height: 900, mobile: width < 500, dark });
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    check("scenarios are no wider than the screen", (await page.worth("document.documentElement.scrollWidth")) <= width, width);
    check("a table that is cut says so", (await page.worth(`document.querySelector(".wrap").classList.contains("cut")`)) === width < 500, width);
    const title = () => text(page, "lineage-title");
    const { names, cells } = expected.scenarios;
    check("the first is open", (await title()) === `1 ${names[0]}: ${cells[0]} cells`, await title());
    // The first cell of the second, where it is drawn: in the middle, at the top.
    const [x, y] = await page.worth(`(() => { const c = document.querySelectorAll("#overview canvas")[1]; c.scrollIntoView({ block: "center" });
      const { left, top } = c.getBoundingClientRect(); for (let x = 0; x < c.clientWidth; x += 3) { c.dispatchEvent(new PointerEvent("pointermove", { clientX: left + x, clientY: top + 22, bubbles: true }));
      if (c.title.startsWith("P0:")) return [left + x + 3, top + 22]; } return [0, 0]; })()`);
    await page.click(x, y);
    await page.until(`document.getElementById("film-state").dataset.cell === "P0"`);
    check("a click in a small tree opens it", (await title()).startsWith(`2 ${names[1]}`) && (await text(page, "cell-name")) === "P0", await title());
    await page.worth(`document.querySelector('th[data-scenario="2"] button').click()`);
    check("so does its column", (await title()) === `3 ${names[2]}: ${cells[2]} cells`, await title());
    check("its column is marked", await page.worth(`document.querySelector('th[data-scenario="2"]').classList.contains("shown")`), "not");
    const found = await slide(page, "r0", 2);
    check("its sliders answer", found.outcome === "asymmetric" || found.outcome === "symmetric", found);
    await shot(page, width < 500 ? "scenarios-narrow-dark" : "scenarios");
    complaints(page, "the scenarios", address);
    await page.close();
  }
}

/** With a clock the tree can be drawn in minutes: a cell is where its birth says. */
async function runsInMinutes(browser) {
  const address = pathToFileURL(expected.timed.page).href;
  for (const width of [1400, 390]) {
    const page = await browser.open(address, { width, height: 900, mobile: width < 500 });
    await page.until("document.documentElement.dataset.ready");
    // The panel grows with its film, and the lineage beside it.
    await page.until(`document.getElementById("film-state").dataset.cell === "P0"`);
    check("the page is no wider than the screen", (await page.worth("document.documentElement.scrollWidth")) <= width, width);
    check("there is a switch", !(await page.worth(`document.getElementById("time-axis").hidden`)), "hidden");
    await frame(page);
    const before = await place(page, "E", [42, 500]);
    await page.worth(`document.getElementById("by-minute").click()`);
    await frame(page);
    await frame(page);
    const [first, after] = [await place(page, "P0", [30, 140]), await place(page, "E", [42, 600])];
    check("E is elsewhere", !near(before[1], after[1], 8), [before, after]);
    const title = await page.worth(`document.getElementById("lineage").title`);
    check("its birth is told", title.startsWith("E:") && title.includes(`born at ${expected.timed.born.toFixed(1)} min`), title);
    check("it is below P0", after[1] > first[1] + 20, [first, after]);
    await shot(page, width < 500 ? "minutes-narrow" : "minutes", false);
    await page.worth(`document.getElementById("by-generation").click()`);
    await frame(page);
    const again = await place(page, "E", [42, 500]);
    check("and back", near(again[0], before[0], 9) && near(again[1], before[1], 9), [before, again]);
    complaints(page, "the page in minutes", address);
    await page.close();
  }
}

/** Keys walk through the tree, open and close. */
async function walks(page) {
  await page.worth(`document.getElementById("lineage").focus()`);
  const name = () => page.worth(`document.getElementById("cell-name").textContent`);
  await page.key("Home");
  await page.key("ArrowDown");
  const first = await name();
  await page.key("ArrowRight");
  const second = await name();
  check("arrows walk", first === "AB" && second === "P1", [first, second]);
  await page.key("Escape");
  check("Escape closes", await page.worth(`document.getElementById("cell-panel").hidden`), "open");
  await page.worth(`(() => { const s = document.getElementById("search"); s.value = "ems"; s.dispatchEvent(new Event("input")); s.focus(); })()`);
  await page.key("Enter");
  check("the search finds", (await name()) === "EMS", await name());
}

async function report(browser) {
  const address = pathToFileURL(expected.report).href;
  const page = await browser.open(address);
  await page.until("document.documentElement.dataset.ready");
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  await shot(page, "wide-light");
  await divides(page);
  const film = await page.worth(`document.getElementById("film").getAttribute("aria-label")`);
  check("the film names its poles", film.includes("anterior on the left, posterior on the right"), film);
  const shows = await text(page, "what-if-shows");
  check("what is shown is said", /on the left anterior \(59 % of the volume\), on the right posterior \(41 %\)/.test(shows), shows);
  await walks(page);
  await staysInView(page);
  await refuses(page);
  await slides(page);
  await regulates(page);
  await waits(page);
  await times(page);
  await saves(page);
  await growsBesideThePanel(page);
  await regrows(page);
  await shot(page, "wide-regrown");
  complaints(page, "the report", address);
  await page.close();
}

/** On a narrow screen nothing is wider than it; dark where the system says so. */
async function narrow(browser) {
  const address = pathToFileURL(expected.report).href;
  for (const dark of [false, true]) {
    const page = await browser.open(address, { width: 390, height: 844, mobile: true, dark });
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    const width = await page.worth("document.documentElement.scrollWidth");
    check("nothing is wider than a telephone", width <= 390, width);
    const names = await page.worth(`Number(document.getElementById("lineage").dataset.names)`);
    check("all founders are named", names === 11, names);
    check("a table that is cut says so", await page.worth(`document.querySelector(".wrap.cut table") !== null`), "none");
    const ground = await page.worth("getComputedStyle(document.body).backgroundColor");
    await page.clickOn("#theme");
    const other = await page.worth("getComputedStyle(document.body).backgroundColor");
    check("the switch changes the colours", ground !== other, [ground, other]);
    await page.clickOn("#theme");
    const [x, y] = await place(page, "AB");
    await page.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [{ x, y }] });
    await page.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await page.until(`document.getElementById("film-state").dataset.cell === "AB"`);
    await shot(page, dark ? "narrow-dark" : "narrow-light");
    complaints(page, "the narrow report", address);
    await page.close();
  }
}

/** A tree grown with a regulator: the movie of its first cell has φ on the contour. */
async function playsARegulator(page) {
  await page.worth(`(() => {
    document.getElementById("cue-on").checked = true;
    document.getElementById("cue-text").value = ${JSON.stringify(expected.regulator.cue)};
    document.getElementById("regrow-cue").value = "?";
    document.getElementById("regrow-state").dataset.state = "";
  })()`);
  await page.clickOn("#regrow");
  await page.until(`["done", "failed"].includes(document.getElementById("regrow-state").dataset.state)`);
  // The tree is drawn in the next frame, and only what is drawn is found under the pointer.
  await frame(page);
  await page.worth(`document.getElementById("lineage").scrollIntoView({ block: "center" })`);
  await page.click(...(await place(page, "P0")));
  await page.until(`document.getElementById("film-state").dataset.cell === "P0"`);
  const [numbers, said] = [await text(page, "cell-numbers"), await text(page, "film-state")];
  check("φ of P0 is among its numbers", numbers.includes(`regulator φ at the furrow${expected.regulator.phi.toFixed(4)}`), numbers);
  check("its movie shows φ", said.includes("The band is the regulator φ: orange above 0, to "), said);
  if (shots) {
    await page.until(`Number(document.getElementById("scrub").value) > 0.72`);
    await shot(page, "mid-division-regulator", false);
  }
}

async function explorer(browser) {
  const address = pathToFileURL(expected.explorer).href;
  const page = await browser.open(address, { dark: true });
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  await type(page, "epsilon", 0.7);
  await page.until(`document.getElementById("phase-edge").textContent.includes("at ε = 0.7,")`);
  const curves = await text(page, "phase-edge");
  check("both lines of the diagram are named", curves.includes("thin broken line is the edge at ε = 0.87"), curves);
  await type(page, "epsilon", 0.87);
  const found = await slide(page, "r0", 2);
  check("the explorer divides", found.outcome === "asymmetric", found);
  await regrows(page);
  check("the grown tree is shown", !(await page.worth(`document.getElementById("lineage-part").hidden`)), "hidden");
  await shot(page, "explore-dark");
  await playsARegulator(page);
  complaints(page, "the explorer", address);
  await page.close();
}

/** Without scripts, and without WebAssembly, what was computed before is there. */
async function still(browser) {
  const address = pathToFileURL(expected.report).href;
  let page = await browser.open(address, { script: false });
  await shot(page, "without-script");
  complaints(page, "the page without scripts", address);
  const { root } = await page.send("DOM.getDocument", { depth: 0 });
  const { nodeIds } = await page.send("DOM.querySelectorAll", { nodeId: root.nodeId, selector: "noscript svg circle, table tbody tr" });
  check("the drawing and the tables are there", nodeIds.length > 100, nodeIds.length);
  await page.close();
  page = await browser.open(address, { before: "delete globalThis.WebAssembly" });
  await page.until("document.documentElement.dataset.ready");
  const told = await page.worth(`document.getElementById("without-solver").innerText`);
  check("the page says that it cannot compute", told.includes("WebAssembly"), told);
  await page.worth(`document.getElementById("lineage").focus()`);
  await page.key("ArrowDown");
  check("its numbers are shown all the same", (await page.worth(`document.getElementById("cell-name").textContent`)) !== "", "nothing");
  await shot(page, "without-wasm");
  complaints(page, "the page without WebAssembly", address);
  await page.close();
}

/** A report of ten thousand cells, if one is given. */
async function large(browser) {
  if (!expected.large) return;
  const start = Date.now();
  const page = await browser.open(pathToFileURL(expected.large).href);
  await page.until("document.documentElement.dataset.ready");
  await frame(page);
  measures.large_ms = Date.now() - start;
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  await shot(page, "large", false);
  await page.worth(`(() => { const s = document.getElementById("search"); s.value = "ms"; s.dispatchEvent(new Event("input")); s.focus(); })()`);
  await page.key("Enter");
  await page.worth("new Promise((resolve) => setTimeout(resolve, 300))");
  await shot(page, "large-found", false);
  check("the large report says nothing", page.complaints.length === 0, page.complaints);
  await page.close();
}

await run([report, narrow, explorer, scenarios, runsInMinutes, large, still]);
