// What a calibration report does besides 3-D: theme, sorting, links to samples, copying the command.
// SPDX-License-Identifier: Apache-2.0
//
// Each part works on what it finds and does nothing otherwise:
//   header.verdict               gets the button that changes the theme (else the page's begin does)
//   table.numbers                headers of one row sort its rows; data-value of a cell goes before its
//                                text; a table with data-fixed keeps its order
//   .command                     gets a button that copies the text of its <code>
//   nav.toc a[href^="#"]         aria-current on the section that is read
//   [data-sample="12"]           class "chosen" while sample 12 is selected; see view3d.js for clicks
(() => {
"use strict";

const all = (selector, within = document) => [...within.querySelectorAll(selector)];
function button(text, action) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.addEventListener("click", () => action(made));
  return made;
}

// Theme: that of the system until the button is pressed; forgotten with the page.
const root = document.documentElement;
const system = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => (root.dataset.theme ?? (system.matches ? "dark" : "light")) === "dark";
function setTheme(theme) {
  if (theme) root.dataset.theme = theme;
  else delete root.dataset.theme;
  document.dispatchEvent(new CustomEvent("kinecal:theme"));
}
function addThemeButton() {
  const name = () => (isDark() ? "Light" : "Dark");
  const made = button(name(), () => {
    setTheme(isDark() ? "light" : "dark");
    made.textContent = name();
  });
  made.className = "theme";
  made.setAttribute("aria-label", "Change between light and dark");
  system.addEventListener("change", () => { made.textContent = name(); });
  const title = document.querySelector("header.verdict h1");
  if (title) title.after(made);
  else document.body.prepend(made);
}
// Paper is light, whatever the screen shows.
let onScreen;
addEventListener("beforeprint", () => {
  onScreen = root.dataset.theme;
  setTheme("light");
});
addEventListener("afterprint", () => setTheme(onScreen));

// Tables.
function keyOf(cell) {
  const text = cell?.dataset.value ?? cell?.textContent.trim() ?? "";
  const number = parseFloat(text.replace(/^[^\d.+\-−]*/, "").replace("−", "-"));
  return { text, number: Number.isFinite(number) ? number : null };
}
function compare(a, b) {
  if (a.number !== null && b.number !== null && a.number !== b.number) return a.number - b.number;
  return a.text.localeCompare(b.text, "en", { numeric: true });
}
/// Cells without a number go last in both directions if the column has numbers.
function sortRows(table, column, ascending) {
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row, place) => ({ row, place, key: keyOf(row.cells[column]) }));
  const hasNumbers = rows.filter((r) => r.key.number !== null).length * 2 > rows.length;
  rows.sort((a, b) => {
    const empty = hasNumbers ? (a.key.number === null) - (b.key.number === null) : 0;
    return empty || (ascending ? 1 : -1) * compare(a.key, b.key) || a.place - b.place;
  });
  body.append(...rows.map((r) => r.row));
}
function makeSortable(table) {
  const headers = [...(table.tHead?.rows[0]?.cells ?? [])];
  const simple = table.tBodies.length === 1 && table.tHead?.rows.length === 1 &&
    !table.querySelector("[colspan], [rowspan]");
  if (!simple || table.tBodies[0].rows.length < 3 || table.hasAttribute("data-fixed")) return;
  headers.forEach((header, column) => {
    if (!header.textContent.trim()) return;
    const made = button("", () => {
      // Numbers begin with the largest one: it is the worst.
      const first = keyOf(table.tBodies[0].rows[0].cells[column]).number === null;
      const now = header.getAttribute("aria-sort");
      const ascending = now ? now === "descending" : first;
      headers.forEach((h) => h.removeAttribute("aria-sort"));
      header.setAttribute("aria-sort", ascending ? "ascending" : "descending");
      sortRows(table, column, ascending);
    });
    made.className = "sort";
    made.append(...header.childNodes);
    header.append(made);
  });
}

// The command that repeats the calibration.
async function copy(text, code) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Not allowed for files in some browsers: select it, so that Ctrl+C is enough.
    getSelection().selectAllChildren(code);
    return document.execCommand("copy");
  }
}
function addCopyButton(command) {
  const code = command.querySelector("code");
  if (!code) return;
  const made = button("Copy", async () => {
    const done = await copy(code.textContent, code);
    made.textContent = done ? "Copied" : "Press Ctrl+C";
    setTimeout(() => { made.textContent = "Copy"; }, 2000);
  });
  made.setAttribute("aria-live", "polite");
  command.append(made);
}

// Where the reader is.
function followSections() {
  const links = new Map(all('nav.toc a[href^="#"]').map((a) => [a.getAttribute("href").slice(1), a]));
  const sections = [...links.keys()].map((id) => document.getElementById(id)).filter(Boolean);
  if (!sections.length) return;
  const seen = new Set();
  const watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) seen.add(target);
      else seen.delete(target);
    }
    const current = sections.find((s) => seen.has(s));
    for (const [id, link] of links) {
      if (id === current?.id) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
  }, { rootMargin: "-15% 0px -55% 0px" });
  sections.forEach((s) => watcher.observe(s));
}

function followSample() {
  let chosen = [];
  document.addEventListener("kinecal:sample", ({ detail }) => {
    chosen.forEach((e) => e.classList.remove("chosen"));
    chosen = all(`[data-sample="${Number(detail.number)}"]`);
    chosen.forEach((e) => e.classList.add("chosen"));
  });
}

addThemeButton();
all("table.numbers").forEach(makeSortable);
all(".command").forEach(addCopyButton);
followSections();
followSample();
})();
