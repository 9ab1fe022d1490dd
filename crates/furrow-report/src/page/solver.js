// The solver, seen from the page: workers made from text inside the page, so that no file and no network is needed.

/** What hinders the solver from running in this browser; null if nothing does. */
function hindrance() {
  if (typeof WebAssembly !== "object") return "it has no WebAssembly";
  if (typeof Worker !== "function") return "it has no workers";
  if (typeof DecompressionStream !== "function") return "it cannot unpack what the page carries";
  return null;
}

let compiled = null;

/** The module, unpacked and compiled once for all workers: what one has warmed up is warm for the others. */
function solverModule() {
  compiled ??= unpacked("furrow-module").then((bytes) => WebAssembly.compile(bytes));
  return compiled;
}

/** One worker with one instance of the solver. Requests are answered in turn. */
class Solver {
  constructor() {
    this.waiting = new Map();
    this.next = 1;
    this.worker = null;
  }

  async open() {
    const module = await solverModule();
    const text = new Blob([element("furrow-worker").textContent], { type: "text/javascript" });
    const address = URL.createObjectURL(text);
    const worker = new Worker(address);
    await new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.ready ? resolve() : reject(new Error(data.error)));
      worker.onerror = (event) => reject(new Error(event.message || "its worker does not start"));
      worker.postMessage({ module });
    });
    URL.revokeObjectURL(address);
    worker.onmessage = ({ data }) => this.take(data);
    return worker;
  }

  take(data) {
    const waiting = this.waiting.get(data.id);
    if (!waiting) return;
    if (data.progress) {
      waiting.progress?.(data.progress);
      return;
    }
    this.waiting.delete(data.id);
    if (data.broken) this.stop();
    if (data.error) waiting.reject(Object.assign(new Error(data.error), { refused: data.refused === true }));
    else waiting.resolve(data);
  }

  /** Asks for "divide", "regrow", "newick", "told" or "edge"; the promise gives {answer, numbers, took}. */
  async ask(call, request, progress) {
    const opening = (this.worker ??= this.open());
    const worker = await opening;
    // Stopped before it was ready.
    if (this.worker !== opening) throw new Error("stopped");
    return new Promise((resolve, reject) => {
      const id = this.next++;
      this.waiting.set(id, { resolve, reject, progress });
      worker.postMessage({ id, call, request });
    });
  }

  /** Ends the worker, whatever it is at; the next request starts another. */
  stop(why = "stopped") {
    this.worker?.then((worker) => worker.terminate(), () => {});
    this.worker = null;
    for (const { reject } of this.waiting.values()) reject(new Error(why));
    this.waiting.clear();
  }
}

/** How long the solver may take for an answer that nobody waits for any more, and for any: in milliseconds. */
const PATIENCE = { unwanted: 400, most: 60_000 };

/** Asks one thing at a time and forgets all that was asked meanwhile but the last: what a moving slider needs. What is computed
 *  when something else is asked is given up, unless it is done in a moment. */
class Latest {
  constructor(solver, run) {
    this.solver = solver;
    this.run = run;
    this.busy = false;
    this.pending = null;
  }

  async ask(request) {
    this.pending = request;
    if (this.busy) {
      this.stopAfter(PATIENCE.unwanted - (performance.now() - this.since), "stopped");
      return;
    }
    this.busy = true;
    while (this.pending !== null) {
      const next = this.pending;
      this.pending = null;
      this.since = performance.now();
      const long = `it took longer than ${PATIENCE.most / 1000} s, the most that this page waits; the command line computes it`;
      this.stopAfter(PATIENCE.most, long);
      await this.run(next, () => this.pending === null);
      clearTimeout(this.timer);
    }
    this.busy = false;
  }

  stopAfter(milliseconds, why) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.solver.stop(why), Math.max(0, milliseconds));
  }
}
