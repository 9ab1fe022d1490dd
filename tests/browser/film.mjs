// A film of a division turns, zooms and plays, and its numbers are those of the command line.
//
//   node film.mjs CHROMIUM EXPECTED.json [FOLDER for screenshots]

import { pathToFileURL } from "node:url";
import { check, complaints, expected, frame, near, run, shot, text } from "./reader.mjs";

const picture = (page) => page.worth(`document.getElementById("surface").toDataURL()`);
const numbers = async (page) => (await page.worth(`[...document.querySelectorAll("#numbers dd")].map((e) => e.textContent.replace("\u2212", "-"))`)).map(Number);

/** Moves a pointer over the picture, pressed. */
async function drag(page, [right, down]) {
  const [x, y] = await page.worth(`(() => { const { left, top, width, height } = document.getElementById("surface").getBoundingClientRect(); return [left + width / 2, top + height / 2]; })()`);
  for (const [type, far] of [["mousePressed", 0], ["mouseMoved", 1], ["mouseReleased", 1]]) {
    await page.send("Input.dispatchMouseEvent", { type, x: x + far * right, y: y + far * down, button: "left", clickCount: 1 });
  }
}

/** The neck after the steps around a time, between them. */
function neckAt(time) {
  const { t, radius, offset } = expected.found.neck;
  const after = Math.max(1, t.findIndex((other) => other >= time - 1e-9));
  const share = (time - t[after - 1]) / (t[after] - t[after - 1]);
  return [radius, offset].map((of) => of[after - 1] + share * (of[after] - of[after - 1]));
}

async function tells(page) {
  const scrub = (place) => page.worth(`(() => { const s = document.getElementById("scrub"); s.value = ${place}; s.dispatchEvent(new Event("input")); })()`);
  const { neck, chi } = expected.found;
  for (const place of [1, 10 / 11, 8 / 11]) {
    await scrub(place);
    const shown = await numbers(page);
    const time = place * neck.t[neck.t.length - 1];
    // What is shown has four decimals.
    check(`the numbers at ${place}`, [time, ...neckAt(time)].every((value, k) => near(value, shown[k], 6e-5)), [shown, time, neckAt(time)]);
    if (place === 1) check("χ at the end", near(shown[3], chi, 1e-3), [shown[3], chi]);
  }
  const there = (await numbers(page))[0];
  await page.key("ArrowRight");
  check("an arrow key goes to the next frame", (await numbers(page))[0] > there, there);
}

async function turns(page) {
  const pole = () => page.worth(`document.getElementById("posterior").style.cssText`);
  const [seen, first] = [[await picture(page)], await pole()];
  const next = async (act) => {
    await act();
    await frame(page);
    seen.push(await picture(page));
  };
  await next(() => drag(page, [120, -40]));
  await next(() => page.key("ArrowUp"));
  await next(() => page.key("+"));
  check("dragging, arrow keys and plus change the picture", new Set(seen).size === seen.length, seen.map((url) => url.length));
  const turned = await pole();
  await page.clickOn("#back");
  check("it turns back", (await pole()) === first && turned !== first, [first, turned, await pole()]);
  await page.worth(`document.getElementById("theme").click()`);
  check("dark is dark", await page.worth(`getComputedStyle(document.body).backgroundColor !== "rgb(245, 246, 248)"`), "light");
}

async function plays(page) {
  await page.worth(`document.getElementById("scrub").value = 0, document.getElementById("scrub").dispatchEvent(new Event("input"))`);
  await page.worth("document.activeElement.blur()");
  await page.key(" ");
  check("space plays", (await text(page, "play")) === "Pause", await text(page, "play"));
  const t = () => numbers(page).then(([t]) => t);
  const early = await t();
  await page.until(`Number(document.getElementById("scrub").value) > 0.3`);
  check("t advances", (await t()) > early, early);
  await page.key(" ");
}

async function film(browser) {
  for (const settings of [{ width: 900, height: 640 }, { width: 390, height: 844, mobile: true }]) {
    const page = await browser.open(pathToFileURL(expected.film).href, settings);
    await page.until("document.documentElement.dataset.ready");
    check("nothing is wider than the screen", await page.worth("document.documentElement.scrollWidth <= innerWidth"), settings);
    if (!settings.mobile) for (const part of [tells, turns, plays]) await part(page);
    // A picture of the whole page resizes it.
    await shot(page, `film-${settings.width}`);
    complaints(page, "the film", pathToFileURL(expected.film).href);
    await page.close();
  }
}

/** Without WebGL the page says so in place of an empty picture. */
async function blind(browser) {
  const page = await browser.open(pathToFileURL(expected.film).href, { before: "HTMLCanvasElement.prototype.getContext = () => null" });
  await page.until(`!document.getElementById("without-film").hidden`);
  check("it says what is missing", (await text(page, "without-film")).includes("no WebGL 2"), await text(page, "without-film"));
  check("there is no empty picture", await page.worth(`document.getElementById("surface").clientWidth === 0`), "a picture");
  await page.close();
}

await run([film, blind]);
