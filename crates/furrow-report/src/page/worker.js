// Runs in a worker of its own: holds one instance of the solver and answers requests, one at a time.
// Messages in: {module}, then {id, call, request}. Messages out: {ready}, {id, progress}, {id, answer, numbers, took}, {id, error}.
"use strict";
let solver = null;
let current = 0;

async function open(module) {
  const imports = { page: { progress: (solved, waiting) => postMessage({ id: current, progress: { solved, waiting } }) } };
  solver = (await WebAssembly.instantiate(module, imports)).exports;
}

function ask(call, request) {
  const text = new TextEncoder().encode(JSON.stringify(request));
  const place = solver.furrow_request(text.length);
  new Uint8Array(solver.memory.buffer, place, text.length).set(text);
  // Only now is the memory looked at again: it may have grown, and its buffer with it.
  const answer = solver["furrow_" + call]();
  const [length, count] = new Uint32Array(solver.memory.buffer, answer, 2);
  const bytes = new Uint8Array(solver.memory.buffer, answer + 8, length);
  const found = JSON.parse(new TextDecoder().decode(bytes));
  const numbers = new Float32Array(solver.memory.buffer, answer + 8 + length, count).slice();
  return [found, numbers];
}

onmessage = async ({ data }) => {
  if (data.module) {
    try {
      await open(data.module);
      postMessage({ ready: true });
    } catch (error) {
      postMessage({ ready: false, error: String(error) });
    }
    return;
  }
  current = data.id;
  try {
    const start = performance.now();
    const [answer, numbers] = ask(data.call, data.request);
    const took = performance.now() - start;
    if (answer?.error) postMessage({ id: data.id, error: answer.error, refused: answer.refused });
    else postMessage({ id: data.id, answer, numbers, took }, [numbers.buffer]);
  } catch (error) {
    // A trap leaves the instance in no state to be asked again.
    postMessage({ id: data.id, error: "the solver stopped (" + error + ")", broken: true });
  }
};
