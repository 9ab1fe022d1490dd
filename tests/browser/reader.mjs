// What every script that drives the page needs: its arguments, and a reader's hands and eyes.
//
//   node SCRIPT.mjs CHROMIUM EXPECTED.json [FOLDER for screenshots]
//
// EXPECTED.json is what the command line says of the same things; see tests/command/page.rs.

import fs from "node:fs";
import path from "node:path";
import { Browser } from "./chromium.mjs";

const [, , program, file] = process.argv;
export const shots = process.argv[4];
export const expected = JSON.parse(fs.readFileSync(file, "utf8"));
const failures = [];
export const measures = {};

export function check(what, right, seen) {
  if (!right) failures.push(`${what}: ${JSON.stringify(seen)}`);
}

export const near = (a, b, tolerance) => Math.abs(a - b) < tolerance;
export const data = (page, id) => page.worth(`({ ...document.getElementById(${JSON.stringify(id)}).dataset })`);
export const shot = async (page, name, whole = true) => shots && page.screenshot(path.join(shots, `${name}.png`), whole);

export function complaints(page, name, address) {
  check(`${name}: the console says nothing`, page.complaints.length === 0, page.complaints);
  const others = page.requests.filter((request) => request !== address);
  check(`${name}: nothing is requested`, others.length === 0, others);
}

/** Moves a slider as a hand does, radii in L_h, and gives what is answered. */
export async function slide(page, quantity, value) {
  await page.worth(`(() => { const s = document.querySelector('input[type=range][data-quantity="${quantity}"]'); s.value = ${value} * (s.dataset.unit ?? 1); s.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  await page.until(`document.getElementById("what-if-result").dataset.state === "done"`);
  return data(page, "what-if-result");
}

/** Types a number beside a slider. */
export const type = (page, quantity, value) => page.worth(`(() => { const s = document.querySelector('input[type=number][data-quantity="${quantity}"]'); s.value = ${value} * (s.dataset.unit ?? 1); s.dispatchEvent(new Event("input", { bubbles: true })); })()`);
export const text = (page, id) => page.worth(`document.getElementById(${JSON.stringify(id)}).textContent`);

/** Where a cell is on the screen, between two heights of the drawing: found by looking for it with the pointer. */
export async function place(page, name, [from, to] = [42, 140]) {
  const found = await page.worth(`(() => {
    const canvas = document.getElementById("lineage");
    const { left, top } = canvas.getBoundingClientRect();
    for (let y = ${from}; y < ${to}; y += 6) for (let x = 0; x < canvas.clientWidth; x += 4) {
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: left + x, clientY: top + y, bubbles: true }));
      if (canvas.title.startsWith(${JSON.stringify(name)} + ":")) return [left + x + 6, top + y + 2];
    }
    return null;
  })()`);
  check(`${name} is in view`, found !== null, found);
  return found ?? [0, 0];
}

/** The next drawing. */
export const frame = (page) => page.worth("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))");

/** Runs parts of a script, each with the browser, and ends with 1 if anything differed. */
export async function run(parts) {
  const browser = await Browser.start(program);
  try {
    for (const part of parts) await part(browser).catch((error) => failures.push(`${part.name}: ${error.message}`));
  } finally {
    await browser.stop();
  }
  console.log(JSON.stringify(measures));
  failures.forEach((failure) => console.error(failure));
  process.exitCode = failures.length ? 1 : 0;
}
