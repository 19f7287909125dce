// Checks reports (--report) as a user of a browser meets them: nothing on the console, no request, every
// control does what it says, everything has a name, nothing is wider than a phone.
//   node check_report.mjs FILE... [--pictures FOLDER]
// It prints a sentence for each mistake, and ends with 1 if there was one.  With --pictures it also writes
// each report in light and dark, 1600 and 400 pixels wide, and as PDF.
// SPDX-License-Identifier: Apache-2.0
import { existsSync, mkdirSync } from "node:fs";
import { basename, join } from "node:path";
import { Browser } from "./browser.mjs";

const PHONE = 360, WIDE = 1600;
const A4 = 688;  // pixels between the margins
const ROLES = new Set(["button", "checkbox", "slider", "link", "image", "img", "application", "textbox",
  "combobox", "radio", "region", "navigation", "Canvas"]);

/// What the picture and the page are after an action, for comparison.
const CANVAS = `document.querySelector("#view3d canvas").toDataURL()`;

/// The mistakes of one report.
class Check {
  mistakes = [];
  constructor(browser, file) {
    this.browser = browser;
    this.file = file;
  }
  expect(holds, sentence) {
    if (!holds) this.mistakes.push(sentence);
    return holds;
  }
  /// Opens the report, looks at it, and takes all that the browser complained about.
  async visit(view, look) {
    const page = await this.browser.open(this.file, view);
    try {
      await look(page);
    } finally {
      const where = `${view.width} pixels, ${view.dark ? "dark" : "light"}`;
      this.mistakes.push(...page.problems.map((p) => `(${where}) ${p}`));
      await page.close();
    }
  }
  /// Does something and expects that a value of the page changes.
  async changes(page, expression, action, sentence) {
    const before = await page.evaluate(expression);
    await action();
    await page.settle();
    return this.expect(before !== await page.evaluate(expression), sentence);
  }
}

/// Sets a slider as a user does: its value, then the event.
async function slide(page, selector, value) {
  await page.evaluate(`(() => {
    const slider = document.querySelector(${JSON.stringify(selector)});
    slider.value = ${value};
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  })()`);
  await page.settle();
}

async function checkText(check, page) {
  const facts = await page.evaluate(`({
    title: document.title,
    language: document.documentElement.lang,
    headings: document.querySelectorAll("h1").length,
    policy: document.querySelector("meta[http-equiv='Content-Security-Policy' i]")?.content ?? "",
    inline: [...document.querySelectorAll("*")].filter((e) => [...e.attributes].some((a) =>
      a.name.startsWith("on") || (a.name === "style" && !e.closest("#view3d")))).length,
    charts: [...document.querySelectorAll("svg")].filter((s) => !s.closest("[aria-hidden=true]") &&
      (s.getAttribute("role") !== "img" || !s.querySelector("title")?.textContent.trim())).length,
    lost: [...document.querySelectorAll("a[href^='#']")].map((a) => a.getAttribute("href"))
      .filter((h) => !/^#sample=[0-9]+$/.test(h) && !document.getElementById(h.slice(1))),
    twice: [...document.querySelectorAll("[id]")].map((e) => e.id)
      .filter((id, i, all) => all.indexOf(id) !== i),
    outside: [...document.querySelectorAll("[src], link[href], a[href]")]
      .map((e) => e.getAttribute("src") ?? e.getAttribute("href"))
      .filter((u) => !u.startsWith("#") && !u.startsWith("data:")).length,
  })`);
  check.expect(facts.title.trim(), "document.title is empty");
  check.expect(facts.language, "the html element has no lang");
  check.expect(facts.headings === 1, `the page has ${facts.headings} h1, expected one`);
  check.expect(facts.policy.includes("default-src 'none'"),
    `the content security policy is "${facts.policy}", expected default-src 'none'`);
  check.expect(facts.inline === 0, `${facts.inline} elements have handlers or styles as attributes`);
  check.expect(facts.charts === 0, `${facts.charts} svg elements lack role="img" or a title`);
  check.expect(!facts.lost.length, `links lead nowhere: ${facts.lost.slice(0, 5).join(", ")}`);
  check.expect(!facts.twice.length, `ids are used twice: ${facts.twice.slice(0, 5).join(", ")}`);
  check.expect(facts.outside === 0, `${facts.outside} links or sources lead out of the file`);
  for (const { role, name } of await page.accessible()) {
    if (ROLES.has(role)) check.expect(name.trim(), `an element of role ${role} has no accessible name`);
  }
}

async function checkContrast(check, page) {
  const weak = await page.evaluate(`(() => {
    const light = (c) => { const [r, g, b] = c.map((v) => (v /= 255) <= 0.04045 ? v / 12.92 :
      ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    const style = getComputedStyle(document.documentElement);
    const of = (name) => { const v = parseInt(style.getPropertyValue("--" + name).trim().slice(1), 16);
      return light([v >> 16, (v >> 8) & 255, v & 255]); };
    const ratio = (a, b) => (Math.max(of(a), of(b)) + 0.05) / (Math.min(of(a), of(b)) + 0.05);
    const texts = ["ink", "muted", "before", "after", "good", "care", "bad", "sigma"];
    return [...texts.flatMap((t) => ["card", "page"].map((p) => [t, p])), ["good", "good-wash"],
      ["care", "care-wash"], ["bad", "bad-wash"], ["ink", "good-wash"], ["ink", "care-wash"],
      ["ink", "bad-wash"], ["muted", "good-wash"], ["muted", "care-wash"], ["muted", "bad-wash"],
      ["muted", "chosen"], ["after", "chosen"]]
      .map(([a, b]) => [a, b, ratio(a, b)]).filter(([, , r]) => !(r >= 4.5))
      .map(([a, b, r]) => a + " on " + b + " is " + r.toFixed(2));
  })()`);
  check.expect(!weak.length, `contrast below 4.5: ${weak.join(", ")}`);
}

async function checkTheme(check, page) {
  const background = "getComputedStyle(document.body).backgroundColor";
  if (!check.expect(await page.evaluate(`!!document.querySelector("button.theme")`),
    "there is no button for the theme")) return;
  const drawn = await page.evaluate(`document.querySelector("#view3d.live") && ${CANVAS}`);
  await check.changes(page, background, () => page.click("button.theme"),
    "the theme button does not change the background");
  check.expect(!drawn || drawn !== await page.evaluate(CANVAS),
    "the theme button does not change the 3-D view");
  await checkContrast(check, page);
  await check.changes(page, background, () => page.click("button.theme"),
    "the theme button does not change the background back");
}

async function checkTables(check, page) {
  const tables = await page.evaluate(
    `[...document.querySelectorAll("table.numbers")].map((t) => t.querySelectorAll("button.sort").length)`);
  for (const [i, buttons] of tables.entries()) {
    if (!buttons) continue;
    const table = `document.querySelectorAll("table.numbers")[${i}]`;
    await page.evaluate(`${table}.querySelector("button.sort").focus({ preventScroll: true })`);
    await page.press("Enter");
    const once = await page.evaluate(`${table}.querySelector("[aria-sort]")?.ariaSort ?? ""`);
    await page.press("Enter");
    const twice = await page.evaluate(`${table}.querySelector("[aria-sort]")?.ariaSort ?? ""`);
    check.expect(once && twice && once !== twice,
      `Enter on a header does not sort table ${i + 1} up and down`);
  }
}

async function checkView(check, page) {
  const has = await page.evaluate(`(() => {
    const figure = document.querySelector("#view3d");
    const there = (selector) => !!figure?.querySelector(selector);
    return { figure: !!figure, live: !!figure?.classList.contains("live"),
      sample: there("#view3d-sample"), factor: there("#view3d-factor"),
      boxes: [...(figure?.querySelectorAll("[type=checkbox]") ?? [])].map((b) => b.name) };
  })()`);
  if (!has.figure) return;
  if (!check.expect(has.live, "the 3-D view is not drawn")) return;
  const changes = (action, sentence) => check.changes(page, CANVAS, action, sentence);
  const status = `document.querySelector("#view3d-status").textContent`;
  if (has.sample) {
    const last = await page.evaluate(`Number(document.querySelector("#view3d-sample").max)`);
    await check.changes(page, status, () => slide(page, "#view3d-sample", last),
      "the slider of samples does not change the description");
    await changes(() => slide(page, "#view3d-sample", 0),
      "the slider of samples does not change the picture");
    await page.evaluate(`document.querySelector("#view3d-sample").focus()`);
    await changes(() => page.press("ArrowRight"), "arrow keys do not move the slider of samples");
    await check.changes(page, status, () => page.click("[aria-label='Next worst sample']"),
      "the button for the worst sample does not change the description");
  }
  if (has.factor) {
    await changes(() => slide(page, "#view3d-factor", 30), "exaggeration does not change the picture");
    await slide(page, "#view3d-factor", 1);
  }
  for (const name of has.boxes) {
    if (name === "points" && !/Largest error|off the robot/.test(await page.evaluate(status))) continue;
    await changes(() => page.click(`#view3d [name=${name}]`), `"${name}" does not change the picture`);
    await page.click(`#view3d [name=${name}]`);
  }
  for (const view of ["Top", "Front", "Side", "Reset"]) {
    await changes(() => page.click(`[aria-label='View: ${view}']`),
      `the button "${view}" does not change the picture`);
  }
  await page.evaluate(`document.querySelector("#view3d canvas").focus()`);
  for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) {
    await changes(() => page.press(key), `the key ${key} does not change the picture`);
  }
  const box = await page.evaluate(`(() => {
    const canvas = document.querySelector("#view3d canvas");
    canvas.scrollIntoView({ block: "center", behavior: "instant" });
    const b = canvas.getBoundingClientRect();
    return [b.left + b.width / 2, b.top + b.height / 2];
  })()`);
  await changes(() => page.drag(box, [box[0] + 60, box[1] + 20]),
    "dragging does not change the picture");
  await changes(() => page.pinch(box, 60, 120), "two fingers do not change the picture");
  const frames = await page.evaluate(`new Promise((done) => {
    const request = window.requestAnimationFrame;
    let count = 0;
    window.requestAnimationFrame = (draw) => { ++count; return request(draw); };
    setTimeout(() => { window.requestAnimationFrame = request; done(count); }, 300);
  })`);
  check.expect(frames === 0, `the view is drawn ${frames} times while nothing happens`);
}

async function checkSampleLinks(check, page) {
  const numbers = await page.evaluate(`(() => {
    const known = JSON.parse(document.querySelector("#scene")?.textContent ?? "{}").samples ?? [];
    const linked = new Set([...document.querySelectorAll("[data-sample]")].map((e) => +e.dataset.sample));
    return known.map((s) => s?.number).filter((n) => linked.has(n));
  })()`);
  if (!numbers.length || !await page.evaluate(`!!document.querySelector("#view3d.live")`)) return;
  const wanted = numbers[numbers.length - 1], status = `document.querySelector("#view3d-status").textContent`;
  await page.evaluate(`document.querySelector("[data-sample='${wanted}']")
    .dispatchEvent(new MouseEvent("click", { bubbles: true }))`);
  await page.settle();
  check.expect((await page.evaluate(status)).startsWith(`Sample ${wanted}`),
    `a click on data-sample="${wanted}" does not select the sample`);
  check.expect(await page.evaluate(`(() => {
    const box = document.querySelector("#view3d canvas").getBoundingClientRect();
    return box.bottom > 0 && box.top < innerHeight;
  })()`), `a click on data-sample="${wanted}" does not show the view`);
  await page.evaluate(`location.hash = "#sample=${numbers[0]}"`);
  await page.settle();
  check.expect((await page.evaluate(status)).startsWith(`Sample ${numbers[0]}`),
    `#sample=${numbers[0]} does not select the sample`);
}

/// Each sample that was left out can be clicked in a chart, and is shown and marked.
async function checkLeftOut(check, page) {
  const numbers = await page.evaluate(`[...new Set([...document.querySelectorAll("svg .target[data-sample]")]
    .map((e) => Number(e.dataset.sample)))]`);
  if (!numbers.length || !await page.evaluate(`!!document.querySelector("#view3d.live")`)) return;
  await page.click(`svg .target[data-sample="${numbers[0]}"]`);
  const text = await page.evaluate(`document.querySelector("#view3d-status").textContent + "|" +
    document.querySelector("#view3d .badge").textContent`);
  check.expect(text.startsWith(`Sample ${numbers[0]}`) && text.includes("left out") &&
    text.endsWith(`sample ${numbers[0]}: left out`) || text.includes("is not among"),
  `a click on sample ${numbers[0]}, which was left out, shows "${text}"`);
}

async function checkWidth(check, page, width) {
  const wide = await page.evaluate(`(() => {
    const limit = document.documentElement.clientWidth + 1;
    const clipped = (e) => { for (let p = e.parentElement; p; p = p.parentElement) {
      if (getComputedStyle(p).overflowX !== "visible") return true; } return false; };
    const over = document.documentElement.scrollWidth > limit;
    return over ? [...document.querySelectorAll("body *")].filter((e) =>
      e.getBoundingClientRect().right > limit && !clipped(e)).slice(0, 3)
      .map((e) => e.tagName.toLowerCase() + "." + (e.getAttribute("class") ?? "")) : null;
  })()`);
  check.expect(wide === null, `the page is wider than ${width} pixels: ${wide?.join(", ")}`);
}

/// A wide screen is used, not a column in its middle.
async function checkDesktop(check, page) {
  const used = await page.evaluate(`document.querySelector("main").getBoundingClientRect().width / innerWidth`);
  check.expect(used > 0.85, `${Math.round(100 * used)} % of a wide screen are used`);
}

/// Labels of charts can be read on a phone.  Correlations of many parameters are a wider picture.
async function checkLabels(check, page) {
  const small = await page.evaluate(`[...document.querySelectorAll("svg.chart")].filter((s) =>
    s.getBoundingClientRect().width > 0 && s.viewBox.baseVal.width <= 420).map((s) => [
      s.querySelector("title").textContent, s.getBoundingClientRect().width / s.viewBox.baseVal.width *
      Math.min(...[...s.querySelectorAll("text")].map((t) => parseFloat(getComputedStyle(t).fontSize)))])
    .filter(([, size]) => size < 9.5).map(([title, size]) => title + ": " + size.toFixed(1))`);
  check.expect(!small.length, `labels of less than 9.5 pixels: ${small.join(", ")}`);
}

/// No sentence stands twice, but in "The report as text".
async function checkSentences(check, page) {
  const twice = await page.evaluate(`(() => {
    const all = [...document.querySelectorAll("p, li, figcaption, h1")].filter((e) =>
      !e.closest("details") && !e.querySelector("p, li")).flatMap((e) =>
      e.textContent.split(/[.;:]\\s/)).map((t) => t.trim()).filter((t) => t.length > 30);
    return all.filter((t, i) => all.indexOf(t) !== i);
  })()`);
  check.expect(!twice.length, `a sentence stands twice: ${twice[0]}`);
}

/// On paper nothing is cut: what is wider than A4 would shrink the whole page, and nobody can scroll.
async function checkPaper(check, page) {
  const heads = await page.evaluate(`[...document.querySelectorAll("table.numbers thead")].filter((e) =>
    getComputedStyle(e).display !== "table-header-group").length`);
  check.expect(heads === 0, `on paper, ${heads} tables do not repeat their headers`);
  await checkWidth(check, page, A4);
  const cut = await page.evaluate(`[...document.querySelectorAll("body *")].filter((e) =>
    getComputedStyle(e).overflowX !== "visible" && e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 &&
    !e.closest(".stage, svg")).slice(0, 3).map((e) => e.tagName.toLowerCase() + "." + e.className)`);
  check.expect(!cut.length, `on paper, these are cut: ${cut.join(", ")}`);
}

async function pictures(check, page, folder, name) {
  if (!folder) return;
  await page.evaluate(`scrollTo({ top: 0, behavior: "instant" })`);
  await page.settle();
  await page.picture({ whole: true, file: join(folder, `${name}.png`) });
}

async function checkReport(browser, file, folder) {
  const check = new Check(browser, file), name = basename(file).replace(/[.]html$/, "");
  await check.visit({ width: WIDE, height: 1000 }, async (page) => {
    await pictures(check, page, folder, `${name}-${WIDE}-light`);
    await checkText(check, page);
    await checkSentences(check, page);
    await checkDesktop(check, page);
    await checkWidth(check, page, WIDE);
    await checkContrast(check, page);
  });
  await check.visit({ width: 900, height: 700 }, async (page) => {
    await checkTheme(check, page);
    await checkTables(check, page);
    await checkView(check, page);
    await checkSampleLinks(check, page);
    await checkLeftOut(check, page);
  });
  await check.visit({ width: PHONE, height: 800, dark: true, scale: 2 }, async (page) => {
    await pictures(check, page, folder, `${name}-${PHONE}-dark`);
    await checkWidth(check, page, PHONE);
    await checkLabels(check, page);
  });
  await check.visit({ width: A4, height: 1000, media: "print" }, (page) => checkPaper(check, page));
  await check.visit({ width: WIDE, height: 1000, webgl: false }, async (page) => {
    check.expect(await page.evaluate(`!document.querySelector("#view3d") ||
      document.querySelector("#view3d .note")?.getBoundingClientRect().height > 0`), "without WebGL, the view does not say so");
  });
  if (folder) {
    for (const view of [{ width: WIDE, height: 1000, dark: true }, { width: PHONE, height: 800 }]) {
      await check.visit(view, async (page) => {
        await pictures(check, page, folder, `${name}-${view.width}-${view.dark ? "dark" : "light"}`);
        if (view.dark) await page.pdf(join(folder, `${name}.pdf`));
      });
    }
  }
  return new Set(check.mistakes);
}

const given = process.argv.slice(2), option = given.indexOf("--pictures");
const folder = option < 0 ? undefined : given.splice(option, 2)[1];
if (!given.length || (option >= 0 && !folder)) {
  console.error("usage: node check_report.mjs FILE... [--pictures FOLDER]");
  process.exit(2);
}
const missing = given.filter((file) => !existsSync(file));
if (missing.length) {
  console.error(`no such file: ${missing.join(", ")}`);
  process.exit(2);
}
if (folder) mkdirSync(folder, { recursive: true });
const browser = await Browser.start();
let mistakes = 0;
try {
  for (const file of given) {
    for (const mistake of await checkReport(browser, file, folder)) {
      ++mistakes;
      console.log(`${file}: ${mistake}`);
    }
  }
} finally {
  await browser.close();
}
process.exitCode = mistakes ? 1 : 0;
