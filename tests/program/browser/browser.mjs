// Headless Chromium for tests of reports: opens files, acts as a user does, and records all that a
// report must not do (console messages, errors, requests).  DevTools protocol over a pipe, no packages.
// SPDX-License-Identifier: Apache-2.0
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const PROGRAMS = [process.env.KINECAL_CHROMIUM, "chromium", "chromium-browser", "google-chrome"];
const FLAGS = [
  "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe",
  "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
  "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-extensions", "--disable-sync", "--mute-audio", "--force-color-profile=srgb"];
/// Longest time that one answer of the browser may take.
const ANSWER_MS = 30000;

function start(program, profile) {
  return new Promise((started, failed) => {
    // A group of its own, so that closing also ends the browser's helper processes.
    const child = spawn(program, [...FLAGS, `--user-data-dir=${profile}`, "about:blank"],
      { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"], detached: true,
        env: { ...process.env, HOME: profile } });
    child.once("error", failed);
    child.once("spawn", () => started(child));
  });
}

async function startFirst(profile) {
  for (const program of PROGRAMS.filter(Boolean)) {
    try {
      return await start(program, profile);
    } catch (error) {
      if (error.code !== "ENOENT") throw error;
    }
  }
  throw new Error("no Chromium found; install chromium, or set KINECAL_CHROMIUM to its path");
}

export class Browser {
  #child; #profile; #next = 1; #waiting = new Map(); #pages = new Map(); #rest = "";

  static async start() {
    const browser = new Browser();
    browser.#profile = mkdtempSync(join(tmpdir(), "kinecal-browser-"));
    process.once("exit", () => browser.#end());
    for (const signal of ["SIGINT", "SIGTERM", "SIGHUP"]) {
      process.once(signal, () => process.exit(1));
    }
    browser.#child = await startFirst(browser.#profile);
    const [, , , input, output] = browser.#child.stdio;
    input.on("error", () => {});  // its end is noticed below
    output.setEncoding("utf8");
    output.on("data", (text) => browser.#receive(text));
    browser.#child.once("exit", () => {
      for (const { failed } of browser.#waiting.values()) failed(new Error("Chromium has ended"));
      browser.#waiting.clear();
    });
    return browser;
  }

  #receive(text) {
    const messages = (this.#rest + text).split("\0");
    this.#rest = messages.pop();
    for (const message of messages.map((m) => JSON.parse(m))) {
      if (message.id === undefined) {
        this.#pages.get(message.sessionId)?.happened(message.method, message.params);
        continue;
      }
      const waiting = this.#waiting.get(message.id);
      this.#waiting.delete(message.id);
      if (message.error) waiting?.failed(new Error(`${waiting.method}: ${message.error.message}`));
      else waiting?.answered(message.result);
    }
  }

  /// Sends a command and waits for its answer.
  send(method, params = {}, sessionId = undefined) {
    const id = this.#next++;
    return new Promise((answered, failed) => {
      const late = setTimeout(() => failed(new Error(`${method}: no answer`)), ANSWER_MS);
      const end = (then) => (value) => { clearTimeout(late); then(value); };
      this.#waiting.set(id, { answered: end(answered), failed: end(failed), method });
      this.#child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
  }

  /// Opens a file.
  /// @param view  {width, height, dark, scale, reducedMotion, webgl, media}; lengths in CSS pixels
  async open(file, view = {}) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } =
      await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(pathToFileURL(resolve(file)).href,
      (method, params) => this.send(method, params, sessionId),
      () => this.send("Target.closeTarget", { targetId }));
    this.#pages.set(sessionId, page);
    await page.load(view);
    return page;
  }

  #end() {
    try {
      if (this.#child?.pid) process.kill(-this.#child.pid, "SIGKILL");
    } catch { /* it has ended already */ }
    if (this.#profile) {
      rmSync(this.#profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
    }
  }

  async close() {
    const child = this.#child;
    const gone = new Promise((done) => child.exitCode === null && child.signalCode === null
      ? child.once("exit", done) : done());
    this.#end();
    await gone;
    this.#end();  // what its helper processes still wrote
  }
}

/// One opened file.
export class Page {
  /// Sentences: console messages, exceptions, violations of the policy, requests.
  problems = [];
  #send; #close; #loaded = [];

  constructor(url, send, close) {
    this.url = url;
    this.#send = send;
    this.#close = close;
  }

  happened(method, params) {
    const report = (text) => this.problems.push(text);
    const handlers = {
      "Runtime.consoleAPICalled": (p) =>
        report(`console.${p.type}: ${p.args.map((a) => a.value ?? a.description).join(" ")}`),
      "Runtime.exceptionThrown": ({ exceptionDetails: e }) =>
        report(`exception: ${e.exception?.description ?? e.text} (line ${e.lineNumber + 1})`),
      "Log.entryAdded": ({ entry: e }) => report(`${e.source} ${e.level}: ${e.text}`),
      "Audits.issueAdded": ({ issue: i }) => {
        if (i.code === "ContentSecurityPolicyIssue") {
          const d = i.details.contentSecurityPolicyIssueDetails;
          report(`content security policy: ${d.violatedDirective} ${d.blockedURL ?? ""}`);
        }
      },
      "Network.requestWillBeSent": ({ request: r }) => {
        if (r.url !== this.url && !r.url.startsWith("data:")) report(`request: ${r.url}`);
      },
      "Page.loadEventFired": () => this.#loaded.splice(0).forEach((done) => done()),
    };
    handlers[method]?.(params);
  }

  async load({ width = 1200, height = 900, dark = false, scale = 1, reducedMotion = true,
    webgl = true, media = "", hash = "" } = {}) {
    for (const domain of ["Page", "Runtime", "Log", "Network", "Audits", "DOM"]) {
      await this.#send(`${domain}.enable`);
    }
    await this.resize(width, height, scale);
    await this.#send("Emulation.setEmulatedMedia", { media, features: [
      { name: "prefers-color-scheme", value: dark ? "dark" : "light" },
      { name: "prefers-reduced-motion", value: reducedMotion ? "reduce" : "no-preference" }] });
    if (!webgl) {
      await this.#send("Page.addScriptToEvaluateOnNewDocument",
        { source: "HTMLCanvasElement.prototype.getContext = () => null;" });
    }
    const loaded = new Promise((done) => this.#loaded.push(done));
    await this.#send("Page.navigate", { url: this.url + hash });
    await loaded;
    await this.settle();
  }

  async resize(width, height, scale = 1) {
    await this.#send("Emulation.setDeviceMetricsOverride",
      { width, height, deviceScaleFactor: scale, mobile: false });
  }

  /// The value of an expression or of a promise in the page.
  async evaluate(expression) {
    const { result, exceptionDetails: e } = await this.#send("Runtime.evaluate",
      { expression, returnByValue: true, awaitPromise: true, userGesture: true });
    if (e) throw new Error(`${expression}: ${e.exception?.description ?? e.text}`);
    return result.value;
  }

  /// Waits until the page has drawn what it was asked to draw.
  async settle() {
    await this.evaluate(`new Promise((done) => requestAnimationFrame(() =>
      requestAnimationFrame(() => setTimeout(done, 0))))`);
  }

  /// Clicks the middle of the first element that a selector names.
  async click(selector) {
    const at = await this.evaluate(`(() => {
      const element = document.querySelector(${JSON.stringify(selector)});
      element.scrollIntoView({ block: "center", behavior: "instant" });
      const box = element.getBoundingClientRect();
      return [box.left + box.width / 2, box.top + box.height / 2];
    })()`);
    await this.drag(at, at);
  }

  /// Presses the left button at a point of the window, moves and releases it.
  async drag([x, y], [to_x, to_y]) {
    const mouse = (type, left, top, buttons) => this.#send("Input.dispatchMouseEvent",
      { type, x: left, y: top, button: "left", buttons, clickCount: 1 });
    await mouse("mousePressed", x, y, 1);
    if (x !== to_x || y !== to_y) await mouse("mouseMoved", to_x, to_y, 1);
    await mouse("mouseReleased", to_x, to_y, 0);
    await this.settle();
  }

  /// Two fingers, left and right of a point, move to another distance of each other.
  async pinch([x, y], distance, to_distance) {
    const touch = (type, d) => this.#send("Input.dispatchTouchEvent", { type,
      touchPoints: d ? [{ x: x - d / 2, y, id: 0 }, { x: x + d / 2, y, id: 1 }] : [] });
    await touch("touchStart", distance);
    await touch("touchMove", to_distance);
    await touch("touchEnd", 0);
    await this.settle();
  }

  /// Presses a key: "ArrowLeft", "Enter", "+".
  async press(key) {
    const codes = { ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Enter: 13, Home: 36,
      End: 35, " ": 32, Tab: 9 };
    const text = key === "Enter" ? "\r" : key.length === 1 ? key : undefined;
    const event = { key, code: key, text, windowsVirtualKeyCode: codes[key] ?? key.charCodeAt(0) };
    await this.#send("Input.dispatchKeyEvent", { type: "keyDown", ...event });
    await this.#send("Input.dispatchKeyEvent", { type: "keyUp", ...event });
    await this.settle();
  }

  /// Roles and names as a screen reader gets them: [{role, name}].
  async accessible() {
    const { nodes } = await this.#send("Accessibility.getFullAXTree");
    return nodes.filter((n) => !n.ignored)
      .map((n) => ({ role: n.role?.value ?? "", name: n.name?.value ?? "" }));
  }

  /// A picture (PNG, base64) of the window, or of the whole page.
  async picture({ whole = false, file = undefined } = {}) {
    const { data } = await this.#send("Page.captureScreenshot",
      { format: "png", captureBeyondViewport: whole, ...(whole && { clip: await this.#extent() }) });
    if (file) writeFileSync(file, Buffer.from(data, "base64"));
    return data;
  }

  async #extent() {
    const [width, height] = await this.evaluate(
      "[document.documentElement.clientWidth, document.documentElement.scrollHeight]");
    return { x: 0, y: 0, width, height: Math.min(height, 16000), scale: 1 };
  }

  /// The page as it would be printed.
  async pdf(file) {
    const { data } = await this.#send("Page.printToPDF",
      { preferCSSPageSize: true, printBackground: true });
    writeFileSync(file, Buffer.from(data, "base64"));
  }

  async close() {
    await this.#close();
  }
}
