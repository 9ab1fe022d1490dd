// The solver, seen from the page: workers made from text inside the page, so that no file and no network is needed.

const element = (id) => document.getElementById(id);

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
  compiled ??= (async () => {
    const packed = Uint8Array.from(atob(element("furrow-module").textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  })();
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
    if (data.error) waiting.reject(new Error(data.error));
    else waiting.resolve(data);
  }

  /** Asks for "divide", "regrow" or "edge"; the promise gives {answer, numbers, took}. */
  async ask(call, request, progress) {
    const worker = await (this.worker ??= this.open());
    return new Promise((resolve, reject) => {
      const id = this.next++;
      this.waiting.set(id, { resolve, reject, progress });
      worker.postMessage({ id, call, request });
    });
  }

  /** Ends the worker, whatever it is at; the next request starts another. */
  stop() {
    this.worker?.then((worker) => worker.terminate(), () => {});
    this.worker = null;
    for (const { reject } of this.waiting.values()) reject(new Error("stopped"));
    this.waiting.clear();
  }
}

/** Asks one thing at a time and forgets all that was asked meanwhile but the last: what a moving slider needs. */
class Latest {
  constructor(run) {
    this.run = run;
    this.busy = false;
    this.pending = null;
  }

  async ask(request) {
    this.pending = request;
    if (this.busy) return;
    this.busy = true;
    while (this.pending !== null) {
      const next = this.pending;
      this.pending = null;
      await this.run(next, () => this.pending === null);
    }
    this.busy = false;
  }
}
