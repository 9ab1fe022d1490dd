// Opens a report and an explorer from disk in a headless Chromium and does with them what a reader does.
//
//   node report.mjs CHROMIUM EXPECTED.json [FOLDER for screenshots]
//
// EXPECTED.json is what the command line says of the same things; see tests/command/page.rs. Prints measures, ends with 1 if anything differs.

import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "./chromium.mjs";

const [, , program, file, shots] = process.argv;
const expected = JSON.parse(fs.readFileSync(file, "utf8"));
const failures = [];
const measures = {};

function check(what, right, seen) {
  if (!right) failures.push(`${what}: ${JSON.stringify(seen)}`);
}

const near = (a, b, tolerance) => Math.abs(a - b) < tolerance;
const data = (page, id) => page.worth(`({ ...document.getElementById(${JSON.stringify(id)}).dataset })`);
const shot = async (page, name, whole = true) => shots && page.screenshot(path.join(shots, `${name}.png`), whole);

function complaints(page, name, address) {
  check(`${name}: the console says nothing`, page.complaints.length === 0, page.complaints);
  const others = page.requests.filter((request) => request !== address);
  check(`${name}: nothing is requested`, others.length === 0, others);
}

/** Moves a slider as a hand does, and gives what is answered. */
async function slide(page, quantity, value) {
  await page.worth(`(() => { const s = document.querySelector('input[type=range][data-quantity="${quantity}"]'); s.value = ${value}; s.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  return data(page, "what-if-result");
}

/** Where a cell of the first generations is on the screen: found by looking for it with the pointer. */
async function place(page, name) {
  const found = await page.worth(`(() => {
    const canvas = document.getElementById("lineage");
    const { left, top } = canvas.getBoundingClientRect();
    for (let y = 42; y < 140; y += 6) for (let x = 0; x < canvas.clientWidth; x += 4) {
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: left + x, clientY: top + y, bubbles: true }));
      if (canvas.title.startsWith(${JSON.stringify(name)} + ":")) return [left + x + 6, top + y + 2];
    }
    return null;
  })()`);
  check(`${name} is in view`, found !== null, found);
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
  await walks(page);
  await slides(page);
  await times(page);
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

async function explorer(browser) {
  const address = pathToFileURL(expected.explorer).href;
  const page = await browser.open(address, { dark: true });
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  const found = await slide(page, "r0", 2);
  check("the explorer divides", found.outcome === "asymmetric", found);
  await regrows(page);
  check("the grown tree is shown", !(await page.worth(`document.getElementById("lineage-part").hidden`)), "hidden");
  await shot(page, "explore-dark");
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
  await page.worth("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))");
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

const browser = await Browser.start(program);
try {
  await report(browser);
  await narrow(browser);
  await explorer(browser);
  await large(browser);
  await still(browser);
} finally {
  await browser.stop();
}
console.log(JSON.stringify(measures));
failures.forEach((failure) => console.error(failure));
process.exitCode = failures.length ? 1 : 0;
