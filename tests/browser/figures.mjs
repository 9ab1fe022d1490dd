// Every figure and number of the page follows what it shows: folded, in minutes, grown anew, in µm, dark and narrow.
//
//   node figures.mjs CHROMIUM EXPECTED.json [FOLDER for screenshots]

import { pathToFileURL } from "node:url";
import { check, complaints, data, expected, frame, near, place, run, shot, slide, text, type } from "./reader.mjs";

/** Records what is drawn in canvases, by the canvas: texts with their alignment, circles. */
const RECORDER = `globalThis.drawn = {};
for (const [name, keep] of [["fillText", ([words, x, y], { textAlign }) => ({ words, x, y, textAlign })], ["arc", ([x, y, radius]) => ({ x, y, radius })]]) {
  const original = CanvasRenderingContext2D.prototype[name];
  CanvasRenderingContext2D.prototype[name] = function (...given) {
    ((globalThis.drawn[this.canvas.id] ??= {})[name] ??= []).push(keep(given, this));
    return original.apply(this, given);
  };
}`;

/** What is drawn in a canvas while something is done. */
async function drawn(page, canvas, act) {
  await page.worth("void (globalThis.drawn = {})");
  await act();
  await frame(page);
  await frame(page);
  return page.worth(`({ fillText: [], arc: [], ...globalThis.drawn[${JSON.stringify(canvas)}] })`);
}

const press = (page, id) => page.worth(`document.getElementById(${JSON.stringify(id)}).click()`);
const answered = (page) => page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
const height = (page) => page.worth("document.documentElement.scrollHeight");

async function opened(browser, file, settings = {}) {
  const page = await browser.open(pathToFileURL(file).href, { height: 900, before: RECORDER, ...settings });
  await page.until("document.documentElement.dataset.ready");
  await answered(page);
  await page.until(`document.getElementById("lineage-part").hidden || document.getElementById("film-state").dataset.cell`);
  await frame(page);
  return page;
}

/** Clicks a cell in the lineage and waits for its film. */
async function clickCell(page, name, rows) {
  await page.worth(`document.getElementById("lineage").scrollIntoView({ block: "start" })`);
  await page.click(...(await place(page, name, rows)));
  await page.until(`document.getElementById("film-state").dataset.cell === ${JSON.stringify(name)}`);
  await frame(page);
}

async function grown(page) {
  await press(page, "regrow");
  await page.until(`["done", "failed"].includes(document.getElementById("regrow-state").dataset.state)`);
  await frame(page);
  check("the tree is grown", (await data(page, "regrow-state")).state === "done", await text(page, "regrow-state"));
}

/** A generation has as many cells when some of them are folded away. */
async function folds(page) {
  const counts = ({ fillText }) => fillText.filter(({ words, textAlign }) => textAlign === "right" && /^\d+$/.test(words)).map(({ words }) => Number(words));
  await clickCell(page, "AB");
  const all = counts(await drawn(page, "lineage", () => press(page, "zoom-fit")));
  const folded = counts(await drawn(page, "lineage", () => press(page, "fold")));
  await shot(page, "folded", false);
  check("every generation is counted", JSON.stringify(all) === JSON.stringify(expected.generations), all);
  check("folding changes no count", JSON.stringify(folded) === JSON.stringify(expected.generations.slice(0, folded.length)) && folded.length > 3, folded);
  await press(page, "unfold");
}

/** The disc of the largest cell is the largest, in generations and in minutes. */
async function discs(page, width) {
  for (const axis of ["by-generation", "by-minute"]) {
    const { arc } = await drawn(page, "lineage", () => press(page, axis));
    const least = Math.min(...arc.map(({ y }) => y));
    const first = Math.max(...arc.filter(({ y }) => y === least).map(({ radius }) => radius));
    // Around a selected cell is a ring, 4 pixels away.
    const largest = Math.max(...arc.filter(({ y }) => y !== least).map(({ radius }) => radius));
    check(`P0 is the largest ${axis} at ${width}`, first > largest, [first, largest]);
    await shot(page, `${axis}-${width}`, false);
  }
  await press(page, "by-generation");
}

/** Minutes after lifetimes that the clock was not fitted to are marked, in the panel, the lineage and the figure. */
async function marksExtrapolated(page) {
  const numbers = await text(page, "cell-numbers");
  check("P0's lifetime is extrapolated", numbers.includes("extrapolated"), numbers);
  const note = () => page.worth(`!document.getElementById("extrapolated").hidden`);
  check("generations need no note", !(await note()), "shown");
  const { fillText } = await drawn(page, "lineage", () => press(page, "by-minute"));
  check("the note is there in minutes", await note(), "hidden");
  const said = fillText.map(({ words }) => words).filter((words) => words.includes(": last "));
  const figure = await text(page, "over-time");
  for (const { name, last_division_min: min, last_division_extrapolated: marked } of expected.founders) {
    const here = said.find((words) => words.startsWith(`${name}: `));
    if (here) check(`${name} in the lineage`, here === `${name}: last ${min.toFixed(0)} min${marked ? "*" : ""}`, here);
    if (min !== undefined) check(`${name} in the figure`, figure.includes(`, ${min.toFixed(0)}*`) === Boolean(marked), figure);
  }
  check("E is marked", said.some((words) => /^E: last \d+ min\*$/.test(words)), said);
  await press(page, "by-generation");
}

/** The sections below the lineage are those that the command line writes of the same tree. */
async function sections(page, browser) {
  const below = (of) => of.worth(`document.getElementById("of-tree").innerText.replace(/, commit [\\w-]+/, "")`);
  const curve = (of) => of.worth(`[...document.querySelectorAll("#over-time path")].map((path) => path.getAttribute("d")).join(" ")`);
  const before = [await below(page), await curve(page), await text(page, "summary")];
  await page.worth(`document.getElementById("regrow-cue").value = "none"`);
  await grown(page);
  const other = await opened(browser, expected.none);
  const [seen, wanted] = [[await below(page), await curve(page)], [await below(other), await curve(other)]];
  await other.close();
  check("the sections are those of the grown tree", seen[0] === wanted[0] && seen[0] !== before[0], seen[0].slice(0, 200));
  check("cells over time are those of the grown tree", seen[1] === wanted[1] && seen[1] !== before[1], seen[1].slice(0, 80));
  await shot(page, "grown");
  await press(page, "regrow-back");
  const again = [await below(page), await curve(page), await text(page, "summary")];
  check("and back", JSON.stringify(again) === JSON.stringify(before), again[2]);
}

/** The diagram has the edge at the sliders' ε, however narrow the shell, and says so where there is none. */
async function edges(page) {
  for (const epsilon of [0.95, 0.96, 0.98]) {
    await type(page, "epsilon", epsilon);
    await page.until(`document.getElementById("phase-edge").textContent.includes("at ε = ${epsilon}")`);
    const said = await text(page, "phase-edge");
    check(`the edge at ε = ${epsilon}`, /The line is the edge of division|No edge/.test(said) && !/line is the edge .* at ε = 0\.87, pale/.test(said), said);
    await answered(page);
    await shot(page, `epsilon-${epsilon}`);
  }
  await slide(page, "epsilon", 0.87);
}

/** A cue may be called by its name in the lineage; what can be copied does not need the name. */
async function namesCues(page) {
  await page.worth(`(() => { const t = document.getElementById("cue-text"); t.value = "germline"; t.dispatchEvent(new Event("change", { bubbles: true })); })()`);
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  const [found, command] = [await data(page, "what-if-result"), await text(page, "command")];
  check("germline is a cue", found.outcome === expected.p0.outcome && near(Number(found.chi), expected.p0.chi, 1e-6), found);
  check("its terms are in the command", command.includes("--cue kappa:band,u0=0.465,omega=0.0577,amplitude=0.1"), command);
}

/** All words can be read: contrast with what is behind them, of at least 4.5 as for WCAG AA. */
async function readable(page, name) {
  const faint = await page.worth(`(() => {
    const paint = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const bytes = (colour) => { paint.clearRect(0, 0, 1, 1); paint.fillStyle = colour; paint.fillRect(0, 0, 1, 1); return [...paint.getImageData(0, 0, 1, 1).data]; };
    const light = (colour) => bytes(colour).slice(0, 3).reduce((sum, byte, k) => { const v = byte / 255; return sum + [0.2126, 0.7152, 0.0722][k] * (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); }, 0);
    const ground = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor; if (bytes(c)[3] === 255) return c; } return "white"; };
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const e = walker.currentNode.parentElement;
      if (!walker.currentNode.data.trim() || !e.checkVisibility() || e.closest(".unseen, :disabled, script, noscript, option")) continue;
      const [ink, behind] = [e.closest("svg") ? getComputedStyle(e).fill : getComputedStyle(e).color, ground(e)].map(light);
      const contrast = (Math.max(ink, behind) + 0.05) / (Math.min(ink, behind) + 0.05);
      if (contrast < 4.5) found.push([walker.currentNode.data.trim().slice(0, 40), contrast]);
    }
    return found;
  })()`);
  check(`${name}: all words can be read`, faint.length === 0, faint.slice(0, 12));
}

/** Numbers with more digits than anybody reads, in the words of the page, its inputs and its pictures' titles. */
async function rounds(page, name) {
  const long = await page.worth(`[document.body.innerText, ...[...document.querySelectorAll("input:not([type=range])")].map((input) => input.value), document.getElementById("lineage").title]
    .flatMap((words) => words.match(/.{0,30}\\d\\.\\d{7,}/g) ?? [])`);
  check(`${name}: numbers are rounded`, long.length === 0, long);
}

/** No answer of the sliders changes the height of the page. */
async function slidesInPlace(page) {
  const heights = [await height(page)];
  for (const [quantity, value] of [["r0", 1.2], ["xi_s", 44], ["epsilon", 0.6], ["r0", 6], ["epsilon", 1.5], ["epsilon", 0.87]]) {
    await type(page, quantity, value);
    await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
    if (value < 1) await page.until(`document.getElementById("phase-edge").textContent.includes("at ε = ${value}") || ${quantity !== "epsilon"}`);
    await frame(page);
    heights.push(await height(page));
  }
  check("no slider changes the height", heights.every((other) => other === heights[0]), heights);
}

/** A click changes the height of nothing on a wide screen; on a telephone the panel of a tapped cell comes into view. */
async function staysPut(browser) {
  const page = await opened(browser, expected.report, { width: 1400 });
  const heights = [await height(page)];
  for (const name of ["AB", "P1", "EMS", "P0"]) {
    await clickCell(page, name, [42, 400]);
    heights.push(await height(page));
  }
  await page.worth(`document.getElementById("close-cell").click()`);
  await frame(page);
  heights.push(await height(page));
  check("no click changes the height", heights.every((other) => other === heights[0]), heights);
  await slidesInPlace(page);
  await page.close();
  const narrow = await opened(browser, expected.report, { width: 390, height: 844, mobile: true });
  await clickCell(narrow, "AB");
  await narrow.until(`Math.abs(document.getElementById("cell-panel").getBoundingClientRect().top) < 40`);
  await slidesInPlace(narrow);
  const tapped = await height(narrow);
  await shot(narrow, "tapped", false);
  await clickCell(narrow, "P1");
  await narrow.until(`Math.abs(document.getElementById("cell-panel").getBoundingClientRect().top) < 40`);
  check("another cell's panel is as tall", near(await height(narrow), tapped, 60), [tapped, await height(narrow)]);
  await narrow.close();
}

/** A lineage in µm has sliders, diagram and scale bars in µm, and round ones. */
async function inMicrometres(browser) {
  const page = await opened(browser, expected.micrometres, { width: 1400 });
  await rounds(page, "a lineage in µm");
  check("the slider is in µm", (await text(page, "r0-unit")) === "µm", await text(page, "r0-unit"));
  const typed = await page.worth(`Number(document.querySelector('input[type=number][data-quantity="r0"]').value)`);
  check("and begins at the first cell", near(typed, 17, 1e-3), typed);
  await page.worth(`(() => { const s = document.querySelector('input[type=number][data-quantity="r0"]'); s.value = 12; s.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  await answered(page);
  check("12 µm are 3.797468 Lₕ", (await data(page, "what-if-result")).r0 === "3.797468" && (await text(page, "command")).includes("--r0 3.797468 "), await text(page, "command"));
  const axis = await drawn(page, "phase", () => page.worth(`dispatchEvent(new Event("resize")), document.getElementById("theme").click()`));
  check("the diagram's axis is in µm", axis.fillText.some(({ words }) => words === "R₀, in µm"), axis.fillText.map(({ words }) => words));
  for (const canvas of ["film", "what-if-cell"]) {
    const bar = await drawn(page, canvas, () => page.worth(`document.getElementById("theme").click()`));
    const words = bar.fillText.map(({ words }) => words).filter((words) => words.endsWith(" µm"));
    check(`${canvas} has a round scale bar`, words.length === 1 && /^0?\.?0*[125]0* µm$/.test(words[0]), words);
  }
  await grown(page);
  await rounds(page, "grown in µm");
  await clickCell(page, "A");
  await rounds(page, "a cell in µm");
  await shot(page, "micrometres");
  complaints(page, "the lineage in µm", pathToFileURL(expected.micrometres).href);
  await page.close();
}

async function follows(browser) {
  for (const [width, dark] of [[1400, false], [1400, true], [390, true]]) {
    const page = await opened(browser, expected.report, { width, dark, mobile: width < 500 });
    const name = `${width} ${dark ? "dark" : "light"}`;
    await readable(page, name);
    await discs(page, width);
    await rounds(page, name);
    if (width > 1000 && !dark) {
      await marksExtrapolated(page);
      await folds(page);
      await namesCues(page);
      await edges(page);
      await sections(page, browser);
    }
    await shot(page, `follows-${name.replace(" ", "-")}`);
    complaints(page, name, pathToFileURL(expected.report).href);
    await page.close();
  }
}

await run([follows, staysPut, inMicrometres]);
