// Manners of our pages, which work without this:
//   [data-rows]            a table or list whose rows j and k go through; o or Enter opens a row's first link
//   table[data-grid]       arrows, Home and End go from cell to cell
//   input[data-filter=ID]  hides the rows of that table that lack what is typed; / goes there. Put it into a [data-js][hidden]
//   [data-live=URL][id]    asked for anew at each event of that stream; data-events names them, default "message"
//   [data-confirm=TEXT]    a button that asks first
//   canvas[data-motion]    the player
// A letter is a key only outside of fields and without Ctrl, Alt or Meta; keys can be turned off in the dialog of "?".

const KEYS = [["j", "next row"], ["k", "row before"], ["o or Enter", "open the row"], ["arrows, Home, End", "from cell to cell of a table of marks"],
  ["/", "filter the table"], ["?", "this list"]];
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const make = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// ---- telling

const spoken = make("p", { className: "spoken", role: "status" });
document.body.append(spoken);
const say = words => { if (spoken.textContent !== words) spoken.textContent = words; };

// ---- rows

const rows = () => all("[data-rows] > tbody > tr, [data-rows] > li").filter(row => !row.hidden && row.offsetParent !== null);

function goTo(element, others) {
  for (const other of others) other.tabIndex = -1;
  element.tabIndex = 0;
  element.focus();
  element.scrollIntoView({ block: "nearest" });
}

function step(by) {
  const known = rows(), at = known.findIndex(row => row.contains(document.activeElement));
  const from = at >= 0 ? at : known.findIndex(row => row.tabIndex === 0 && row.dataset.been);
  const next = known[from < 0 ? (by > 0 ? 0 : known.length - 1) : Math.min(Math.max(from + by, 0), known.length - 1)];
  if (!next) return;
  for (const row of known) delete row.dataset.been;
  next.dataset.been = "yes";
  goTo(next, known);
}

function open(row) {
  row?.querySelector("a[href]")?.click();
}

// ---- cells

const stop = cell => cell.querySelector("a[href], button") ?? cell;

function enterGrid(table) {
  const stops = all("tbody th, tbody td", table).map(stop);
  stops.forEach((one, at) => { one.tabIndex = at === 0 ? 0 : -1; });
}

function moveInGrid(event, table) {
  const cell = event.target.closest("th, td"), row = cell?.parentElement;
  if (!row || !table.tBodies[0]?.contains(row)) return false;
  const shown = [...table.tBodies[0].rows].filter(one => !one.hidden), at = shown.indexOf(row);
  const beside = row.cells[cell.cellIndex + { ArrowLeft: -1, ArrowRight: 1 }[event.key]];
  const above = shown[at + { ArrowUp: -1, ArrowDown: 1 }[event.key]]?.cells[cell.cellIndex];
  const edge = { Home: row.cells[0], End: row.cells[row.cells.length - 1] }[event.key];
  const next = beside ?? above ?? edge;
  if (next) goTo(stop(next), [stop(cell), ...all('[tabindex="0"]', table.tBodies[0])]);
  return Boolean(next);
}

// ---- filter

const folded = words => words.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase();

function filter(input) {
  const table = document.getElementById(input.dataset.filter), wanted = folded(input.value.trim());
  const known = all(":scope > tbody > tr", table);
  for (const row of known) row.hidden = !folded(row.textContent).includes(wanted);
  const shown = known.find(row => !row.hidden), entry = table.querySelector('tbody [tabindex="0"]');
  if (shown && entry?.closest("tr").hidden) {
    entry.tabIndex = -1;
    (table.matches("[data-grid]") ? stop(shown.cells[0]) : shown).tabIndex = 0;
  }
  say(wanted ? `${known.filter(row => !row.hidden).length} of ${known.length} rows` : `all ${known.length} rows`);
}

// ---- keys

const off = () => { try { return localStorage.getItem("keys") === "off"; } catch { return false; } };

const help = make("dialog", { id: "keys" });
help.setAttribute("aria-labelledby", "keys-title");

function showKeys() {
  const list = make("dl", {}, ...KEYS.flatMap(([key, does]) => [make("dt", {}, make("kbd", { textContent: key })), make("dd", { textContent: does })]));
  const box = make("input", { type: "checkbox", checked: !off() });
  box.addEventListener("change", () => { try { localStorage.setItem("keys", box.checked ? "on" : "off"); } catch { /* not kept */ } });
  const close = make("form", { method: "dialog" }, make("button", { textContent: "Close" }));
  help.replaceChildren(make("h2", { id: "keys-title", textContent: "Keys" }), list, make("p", {}, make("label", {}, box, " letters are keys")), close);
  if (!help.open) help.showModal();
}

function pressed(event) {
  if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey || help.open) return;
  const target = event.target;
  if (target.closest?.("input, textarea, select, [contenteditable]")) return;
  const grid = target.closest?.("table[data-grid]");
  if (grid && moveInGrid(event, grid)) return event.preventDefault();
  const row = target.closest?.("[data-rows] > tbody > tr, [data-rows] > li");
  if (event.key === "Enter" && target === row) return open(row);
  const list = target === row && !grid;
  if (list && event.key === "ArrowDown") { event.preventDefault(); return step(1); }
  if (list && event.key === "ArrowUp") { event.preventDefault(); return step(-1); }
  if (off()) return;
  const does = { j: () => step(1), k: () => step(-1), o: () => open(row), "?": showKeys, "/": () => document.querySelector("input[data-filter]")?.focus() }[event.key];
  if (does) { event.preventDefault(); does(); }
}

// ---- live

function live(element) {
  const stream = new EventSource(element.dataset.live);
  let asking = false, again = false, lost;
  const over = () => { clearTimeout(lost); stream.close(); };
  async function renew() {
    if (asking) { again = true; return; }
    asking = true;
    try {
      const answer = await fetch(location.href, { headers: { Accept: "text/html" } });
      const fresh = answer.ok && new DOMParser().parseFromString(await answer.text(), "text/html").getElementById(element.id);
      if (fresh) replace(element, fresh);
      if (fresh && !fresh.dataset.live) over();
    } catch { /* the stream tells when there is a connection again */ }
    asking = false;
    if (again) { again = false; renew(); }
  }
  for (const name of (element.dataset.events ?? "message").split(" ")) stream.addEventListener(name, renew);
  stream.addEventListener("open", () => { clearTimeout(lost); lost = undefined; say(""); });
  stream.addEventListener("error", () => {
    lost ??= setTimeout(() => say(stream.readyState === EventSource.CLOSED ? "Connection lost: load the page again." : "Connection lost, trying again…"), 2000);
  });
  addEventListener("pagehide", over, { once: true });
}

function replace(element, fresh) {
  const active = document.activeElement, inside = element.contains(active) && active !== element;
  const same = inside && (active.id ? `#${CSS.escape(active.id)}` : active.name ? `[name="${CSS.escape(active.name)}"]`
    : active.getAttribute("href") ? `[href="${CSS.escape(active.getAttribute("href"))}"]` : null);
  const typing = inside && active.matches("input, textarea, select");
  const opened = all("details[open]", element).map(one => one.querySelector("summary")?.textContent);
  if (typing) return; // what is being filled in stays; the next event shows what is new
  element.replaceChildren(...fresh.childNodes);
  for (const one of all("details", element)) if (opened.includes(one.querySelector("summary")?.textContent)) one.open = true;
  prepare(element);
  if (same) element.querySelector(same)?.focus({ preventScroll: true });
  for (const input of all("input[data-filter]")) if (input.value) filter(input);
}

// ---- all of it

function prepare(root) {
  for (const one of all("[data-js]", root)) one.hidden = false;
  for (const table of all("table[data-grid]", root)) enterGrid(table);
  for (const row of all("[data-rows] > tbody > tr, [data-rows] > li", root)) row.tabIndex = -1;
  for (const list of all("[data-rows]", root)) {
    const first = list.querySelector(":scope > tbody > tr, :scope > li");
    if (first && !list.matches("[data-grid]")) first.tabIndex = 0;
  }
  const motions = all("canvas[data-motion]", root);
  if (motions.length) import("./player.js").then(player => motions.forEach(player.play));
}

document.body.append(help);
document.addEventListener("keydown", pressed);
document.addEventListener("input", event => { if (event.target.matches?.("input[data-filter]")) filter(event.target); });
document.addEventListener("submit", event => {
  const asked = event.submitter?.dataset.confirm;
  if (asked && !confirm(asked)) event.preventDefault();
});
const bar = document.querySelector("header nav");
if (bar) {
  const button = make("button", { type: "button", className: "keys", textContent: "?", title: "Keys" });
  button.setAttribute("aria-label", "Keys");
  button.addEventListener("click", showKeys);
  bar.append(button);
}
prepare(document);
for (const element of all("[data-live][id]")) live(element);
