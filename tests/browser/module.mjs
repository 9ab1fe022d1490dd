// Asks the module of the page, without a browser, for divisions of a tree and for the tree itself.
//
//   node module.mjs furrow.wasm.txt tree.json
//
// Prints measures; ends with 1 if anything differs from tree.json.

import fs from "node:fs";
import zlib from "node:zlib";

const [, , moduleFile, treeFile] = process.argv;
const packed = fs.readFileSync(moduleFile, "utf8").split("\n")[1];
const bytes = zlib.gunzipSync(Buffer.from(packed, "base64"));
let told = 0;
const { instance } = await WebAssembly.instantiate(bytes, { page: { progress: (solved) => (told = solved) } });
const solver = instance.exports;
const tree = JSON.parse(fs.readFileSync(treeFile, "utf8"));
const { lineage, cell, numerics, seed, r0_step } = tree;
const failures = [];

function ask(call, request) {
  const text = new TextEncoder().encode(JSON.stringify(request));
  // Before the memory is looked at, which may grow with it.
  const place = solver.furrow_request(text.length);
  new Uint8Array(solver.memory.buffer, place, text.length).set(text);
  const answer = solver[`furrow_${call}`]();
  const [length] = new Uint32Array(solver.memory.buffer, answer, 1);
  return JSON.parse(new TextDecoder().decode(new Uint8Array(solver.memory.buffer, answer + 8, length)));
}

// One cell of every radius, of those whose division was computed.
const founders = new Map(lineage.founders.map((founder) => [founder.name, founder]));
const solved = new Map(tree.cells.filter((c) => c.t_end !== null).map((c) => [`${c.r0.toPrecision(9)} ${JSON.stringify(c.cue)}`, c]));
let farthest = 0;
const start = performance.now();
for (const { name, r0, cue, founder, outcome, chi } of solved.values()) {
  const physics = founders.get(founder).physics ?? {};
  const found = ask("divide", { cell: { ...cell, r0, cue }, numerics, seed, r0_step, physics, frames: "last" });
  if (found.outcome !== outcome) failures.push(`${name}: ${found.outcome ?? found.error}, not ${outcome}`);
  if (chi !== null) farthest = Math.max(farthest, Math.abs(found.chi - chi));
}
const mean = (performance.now() - start) / solved.size;
if (!(farthest < 1e-6)) failures.push(`χ is off by ${farthest}`);

const before = performance.now();
const grown = ask("regrow", { lineage, cell, numerics, seed, r0_step });
const seconds = (performance.now() - before) / 1000;
const alike = (a, b) => a.name === b?.name && a.outcome === b.outcome && Math.abs((a.chi ?? 0) - (b.chi ?? 0)) < 1e-6;
if (grown.cells?.length !== tree.cells.length) failures.push(`the tree has ${grown.cells?.length ?? grown.error} cells, not ${tree.cells.length}`);
grown.cells?.forEach((c, k) => alike(c, tree.cells[k]) || failures.push(`${c.name} is not as in the tree`));
if (told === 0) failures.push("growth was not told of");

const refused = ask("divide", { cell: { ...cell, r0: -1 }, numerics, seed });
if (!refused.error?.includes("r0")) failures.push(`a radius below 0 is not refused: ${JSON.stringify(refused)}`);
const unread = ask("edge", { what: 1 });
if (!unread.error) failures.push("nonsense is not refused");

console.log(JSON.stringify({ divisions: solved.size, mean_ms: Math.round(mean), chi_off: farthest, tree_s: Number(seconds.toFixed(2)) }));
failures.slice(0, 10).forEach((failure) => console.error(failure));
process.exitCode = failures.length ? 1 : 0;
