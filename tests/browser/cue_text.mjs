// Writes cues as the page does.
//
//   node cue_text.mjs DATA.js CASES.json
//
// CASES.json lists pairs of a cue, as files have it, and its text on the command line. Ends with 1 if the page has another.

import fs from "node:fs";

const [, , source, cases] = process.argv;
const text = fs.readFileSync(source, "utf8");
const from = text.indexOf("function cueText");
const cueText = new Function(`${text.slice(from, text.indexOf("\n}\n", from) + 3)}; return cueText;`)();
for (const [cue, expected] of JSON.parse(fs.readFileSync(cases, "utf8"))) {
  if (cueText(cue) !== expected) {
    console.error(`${cueText(cue)} and expected ${expected}`);
    process.exitCode = 1;
  }
}
