// Drives a headless Chromium over its DevTools protocol, through pipes: no ports, no packages.

import { spawn } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

/** Longest wait for anything in a page, in milliseconds. The machine may be busy. */
const PATIENCE = 60_000;

export class Browser {
  /** Starts a browser with a profile that goes with it. */
  static async start(program, flags = []) {
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), "furrow-page-"));
    // Without a graphics card recent versions draw WebGL, which films need, only if they are told to.
    const always = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--remote-debugging-pipe", `--user-data-dir=${profile}`];
    const child = spawn(program, [...always, ...flags, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    return new Browser(child, profile);
  }

  constructor(child, profile) {
    this.child = child;
    this.profile = profile;
    this.next = 1;
    this.waiting = new Map();
    this.listeners = [];
    let rest = Buffer.alloc(0);
    child.stdio[4].on("data", (chunk) => {
      rest = Buffer.concat([rest, chunk]);
      for (let end = rest.indexOf(0); end >= 0; end = rest.indexOf(0)) {
        this.take(JSON.parse(rest.subarray(0, end).toString()));
        rest = rest.subarray(end + 1);
      }
    });
    child.on("exit", () => {
      for (const { reject } of this.waiting.values()) reject(new Error("the browser ended"));
    });
  }

  take(message) {
    const waiting = this.waiting.get(message.id);
    if (!waiting) {
      this.listeners.forEach((listener) => listener(message));
      return;
    }
    this.waiting.delete(message.id);
    if (message.error) waiting.reject(new Error(message.error.message));
    else waiting.resolve(message.result);
  }

  send(method, params = {}, sessionId = undefined) {
    return new Promise((resolve, reject) => {
      const id = this.next++;
      this.waiting.set(id, { resolve, reject });
      this.child.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + "\0");
    });
  }

  /** Opens a page of a size; the script `before` is run before its own. */
  async open(address, { width = 1400, height = 1000, mobile = false, dark = false, script = true, before = "" } = {}) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(this, sessionId, targetId);
    this.listeners.push((message) => page.hear(message));
    for (const domain of ["Page", "Runtime", "Network", "Log"]) await page.send(`${domain}.enable`);
    // Workers are pages' parts too: what they ask of the network counts.
    await page.send("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: false, flatten: true });
    await page.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile });
    if (mobile) await page.send("Emulation.setTouchEmulationEnabled", { enabled: true });
    await page.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }] });
    if (!script) await page.send("Emulation.setScriptExecutionDisabled", { value: true });
    if (before) await page.send("Page.addScriptToEvaluateOnNewDocument", { source: before });
    const loaded = page.once("Page.loadEventFired");
    await page.send("Page.navigate", { url: address });
    await loaded;
    return page;
  }

  async stop() {
    const gone = new Promise((resolve) => this.child.on("exit", resolve));
    await this.send("Browser.close").catch(() => {});
    await gone;
    fs.rmSync(this.profile, { recursive: true, force: true });
  }
}

class Page {
  constructor(browser, session, target) {
    Object.assign(this, { browser, session, target });
    /** What must not be: errors on the console, and requests beyond the page itself. */
    this.complaints = [];
    this.requests = [];
    this.awaited = [];
  }

  send(method, params = {}) {
    return this.browser.send(method, params, this.session);
  }

  hear({ method, params, sessionId }) {
    if (method === "Target.attachedToTarget" && sessionId === this.session) {
      this.parts ??= new Set();
      this.parts.add(params.sessionId);
      this.browser.send("Network.enable", {}, params.sessionId).catch(() => {});
      this.browser.send("Runtime.enable", {}, params.sessionId).catch(() => {});
      return;
    }
    if (sessionId !== this.session && !this.parts?.has(sessionId)) return;
    if (method === "Runtime.exceptionThrown") this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && ["error", "warning"].includes(params.type)) this.complaints.push(params.args.map((a) => a.value ?? a.description).join(" "));
    if (method === "Log.entryAdded" && params.entry.level === "error") this.complaints.push(`${params.entry.text} ${params.entry.url ?? ""}`);
    if (method === "Network.requestWillBeSent" && !/^(data|blob):/.test(params.request.url)) this.requests.push(params.request.url);
    this.awaited = this.awaited.filter(({ name, resolve }) => name !== method || resolve(params));
  }

  once(name) {
    return new Promise((resolve) => this.awaited.push({ name, resolve: (params) => void resolve(params) }));
  }

  /** What an expression is worth in the page. */
  async worth(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
    return result.value;
  }

  /** Waits until an expression is true. */
  async until(expression) {
    const start = Date.now();
    while (!(await this.worth(`Boolean(${expression})`))) {
      if (Date.now() - start > PATIENCE) throw new Error(`${expression} is not true after ${PATIENCE / 1000} s`);
      await new Promise((resolve) => setTimeout(resolve, 30));
    }
  }

  async click(x, y) {
    for (const type of ["mousePressed", "mouseReleased"]) await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1 });
  }

  /** Clicks the middle of an element, after bringing it into view. */
  async clickOn(selector) {
    const [x, y] = await this.worth(`(() => { const e = document.querySelector(${JSON.stringify(selector)}); e.scrollIntoView({ block: "center" });
      const { left, top, width, height } = e.getBoundingClientRect(); return [left + width / 2, top + height / 2]; })()`);
    await this.click(x, y);
  }

  async key(key) {
    const text = key.length === 1 ? key : key === "Enter" ? "\r" : undefined;
    const codes = { Enter: 13, Escape: 27, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 };
    const common = { key, code: key, windowsVirtualKeyCode: codes[key] ?? key.toUpperCase().charCodeAt(0) };
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", text, ...common });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", ...common });
  }

  async screenshot(file, whole = true) {
    const { data } = await this.send("Page.captureScreenshot", { format: "png", captureBeyondViewport: whole, ...(whole ? { clip: await this.whole() } : {}) });
    fs.writeFileSync(file, Buffer.from(data, "base64"));
  }

  async whole() {
    const { cssContentSize } = await this.send("Page.getLayoutMetrics");
    return { x: 0, y: 0, width: cssContentSize.width, height: Math.min(cssContentSize.height, 4000), scale: 1 };
  }

  async close() {
    await this.browser.send("Target.closeTarget", { targetId: this.target });
  }
}
