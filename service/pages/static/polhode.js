// Progressive enhancement: every page also works without JavaScript.
//   [data-rows]            table or list; j and k move between its rows, o or Enter opens a row's first link, or its a[data-main]
//   table[data-grid]       arrow keys, Home and End move between cells
//   input[data-filter=ID]  hides the rows of table ID that do not contain the typed text; / focuses it. Wrap it in [data-js][hidden]
//   [data-live=URL][id]    is reloaded at each event of the stream URL; data-events lists the event names, default "message"
//   [data-confirm=TEXT]    button that asks for confirmation
//   form[data-saved=TEXT]  is sent in the background: an error appears beside its field and nothing typed is lost; then TEXT is announced.
//                          If a file is the answer, it is downloaded, and data-downloaded takes the form's place
//   form[data-drop]        takes a file that is dropped on it; a [data-question] in the page that answers is shown in it, with the file kept
//   [data-asks=NAMES]      is shown once a field of the form whose name begins so was rejected
//   select[data-limits=NAME] sets the maximum of the field NAME to data-max of the chosen option, and shows it in the form's [data-limit]
//   input[data-token]      is filled with the token of a link to /login#token=… or /start#token=…
//   form[data-lines]       takes cell and line from a click on a line of the source
//   canvas[data-motion]    motion player, see player.js
//   img[data-reload=ID]    is of the part ID, which says more once the image is there
// Letter shortcuts work only outside form fields and without Ctrl, Alt or Meta. The "?" dialog, which is help, turns them off.

const KEYS = [["j", "next row"], ["k", "previous row"], ["o or Enter", "open the row"], ["arrows, Home, End", "move between the cells of the class table"],
  ["/", "filter the table"], ["?", "show this help"]];
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const make = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// ---- announcements

const spoken = make("p", { className: "hidden" }); // for screen readers only
spoken.setAttribute("aria-live", "polite");
const announcement = make("p", { className: "announcement notice", role: "status" }); // in the flow of the page: it covers nothing
document.body.append(spoken);
(document.getElementById("main") ?? document.body).prepend(announcement);
const announce = text => { if (announcement.textContent !== text) announcement.textContent = text; };

function announceSaved(text) {
  if (!text) return;
  document.getElementById(decodeURIComponent(location.hash.slice(1)))?.before(announcement); // where the form was
  announce(text);
}

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
  const from = at >= 0 ? at : known.findIndex(row => row.tabIndex === 0 && row.dataset.visited);
  const next = known[from < 0 ? (by > 0 ? 0 : known.length - 1) : Math.min(Math.max(from + by, 0), known.length - 1)];
  if (!next) return;
  for (const row of known) delete row.dataset.visited;
  next.dataset.visited = "yes";
  goTo(next, known);
}

function open(row) {
  (row?.querySelector("a[data-main]") ?? row?.querySelector("a[href]"))?.click();
}

// ---- cells

const focusable = cell => cell.querySelector("a[href], button") ?? cell;

function enterGrid(table) {
  const targets = all("tbody th, tbody td", table).map(focusable);
  targets.forEach((one, at) => { one.tabIndex = at === 0 ? 0 : -1; });
}

function moveInGrid(event, table) {
  const cell = event.target.closest("th, td"), row = cell?.parentElement;
  if (!row || !table.tBodies[0]?.contains(row)) return false;
  const shown = [...table.tBodies[0].rows].filter(one => !one.hidden), at = shown.indexOf(row);
  const sideways = row.cells[cell.cellIndex + { ArrowLeft: -1, ArrowRight: 1 }[event.key]];
  const vertical = shown[at + { ArrowUp: -1, ArrowDown: 1 }[event.key]]?.cells[cell.cellIndex];
  const edge = { Home: row.cells[0], End: row.cells[row.cells.length - 1] }[event.key];
  const next = sideways ?? vertical ?? edge;
  if (next) goTo(focusable(next), [focusable(cell), ...all('[tabindex="0"]', table.tBodies[0])]);
  return Boolean(next);
}

// ---- filter

const normalized = text => text.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase();

function filter(input) {
  const table = document.getElementById(input.dataset.filter), wanted = normalized(input.value.trim());
  const known = all(":scope > tbody > tr", table);
  for (const row of known) row.hidden = !normalized(row.textContent).includes(wanted);
  const shown = known.find(row => !row.hidden), entry = table.querySelector('tbody [tabindex="0"]');
  if (shown && entry?.closest("tr").hidden) {
    entry.tabIndex = -1;
    (table.matches("[data-grid]") ? focusable(shown.cells[0]) : shown).tabIndex = 0;
  }
  spoken.textContent = wanted ? `${known.filter(row => !row.hidden).length} of ${known.length} rows` : `all ${known.length} rows`;
}

// ---- keys

const shortcutsOff = () => { try { return localStorage.getItem("keys") === "off"; } catch { return false; } };

const help = make("dialog", { id: "keys" });
help.setAttribute("aria-labelledby", "keys-title");

function showKeys() {
  const list = make("dl", {}, ...KEYS.flatMap(([key, effect]) => [make("dt", {}, make("kbd", { textContent: key })), make("dd", { textContent: effect })]));
  const box = make("input", { type: "checkbox", checked: !shortcutsOff() });
  box.addEventListener("change", () => { try { localStorage.setItem("keys", box.checked ? "on" : "off"); } catch { /* storage is disabled */ } });
  const close = make("form", { method: "dialog" }, make("button", { textContent: "Close" }));
  const more = make("p", {}, make("a", { href: "/help", textContent: "How to submit, read a report and ask for a regrade" }));
  help.replaceChildren(make("h2", { id: "keys-title", textContent: "Help" }), more, make("h3", { textContent: "Keyboard shortcuts" }), list, make("p", {}, make("label", {}, box, " enable letter shortcuts")), close);
  if (!help.open) help.showModal();
}

function onKeydown(event) {
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
  if (shortcutsOff()) return;
  const action = { j: () => step(1), k: () => step(-1), o: () => open(row), "?": showKeys, "/": () => document.querySelector("input[data-filter]")?.focus() }[event.key];
  if (action) { event.preventDefault(); action(); }
}

// ---- live

// Show where a submission is. Return whether its page has that place, so that nothing needs to be reloaded.
function progress(element, event) {
  const line = element.querySelector("[data-progress]");
  if (!line || !["queued", "running"].includes(event.type)) return false;
  const { position, scene, scenes } = JSON.parse(event.data);
  line.textContent = event.type === "queued" ? `Queued${position ? `, position ${position}` : ""}.` : `Running${scenes ? ` scene ${scene} of ${scenes}` : ""}.`;
  const bar = element.querySelector("progress");
  bar.hidden = !scenes;
  if (scenes) Object.assign(bar, { max: scenes, value: scene });
  return true;
}

// Replace a part by that of the present page. Return the fresh one, null if there is none.
async function reloadPart(element) {
  const answer = await fetch(location.href, { headers: { Accept: "text/html" } });
  const fresh = answer.ok && new DOMParser().parseFromString(await answer.text(), "text/html").getElementById(element.id);
  if (fresh) replace(element, fresh);
  return fresh;
}

function live(element) {
  const stream = new EventSource(element.dataset.live);
  let loading = false, again = false, lost;
  const close = () => { clearTimeout(lost); stream.close(); };
  async function reload() {
    if (loading) { again = true; return; }
    loading = true;
    try {
      const fresh = await reloadPart(element);
      if (fresh && !fresh.dataset.live) close();
    } catch { /* the event stream reconnects and triggers the next reload */ }
    loading = false;
    if (again) { again = false; reload(); }
  }
  for (const name of (element.dataset.events ?? "message").split(" ")) stream.addEventListener(name, event => progress(element, event) || reload());
  stream.addEventListener("open", () => {
    clearTimeout(lost);
    lost = undefined;
    if (announcement.textContent.startsWith("Connection lost")) announce("");
  });
  stream.addEventListener("error", () => {
    lost ??= setTimeout(() => announce(stream.readyState === EventSource.CLOSED ? "Connection lost. Reload the page." : "Connection lost. Reconnecting…"), 2000);
  });
  addEventListener("pagehide", close, { once: true });
}

function replace(element, fresh) {
  const active = document.activeElement, inside = element.contains(active) && active !== element;
  const same = inside && (active.id ? `#${CSS.escape(active.id)}` : active.name ? `[name="${CSS.escape(active.name)}"]`
    : active.getAttribute("href") ? `[href="${CSS.escape(active.getAttribute("href"))}"]` : null);
  const typing = inside && active.matches("input, textarea, select");
  const opened = all("details[open]", element).map(one => one.querySelector("summary")?.textContent);
  if (typing) return; // keep a form field that the user is editing; the next event updates the page
  element.replaceChildren(...fresh.childNodes);
  for (const one of all("details", element)) if (opened.includes(one.querySelector("summary")?.textContent)) one.open = true;
  prepare(element);
  if (same) element.querySelector(same)?.focus({ preventScroll: true });
  for (const input of all("input[data-filter]")) if (input.value) filter(input);
}

// ---- forms

function refuse(form, detail, pointer) {
  const field = form.elements[(pointer ?? "").slice(1)], at = field instanceof HTMLElement ? field : form.querySelector("button");
  const note = make("p", { className: "refused", id: "refused", textContent: detail });
  note.setAttribute("role", "alert");
  (at.closest("p, label") ?? at).after(note);
  for (const box of all("[data-asks]", form)) if (field?.name?.startsWith(box.dataset.asks)) box.hidden = false;
  if (at !== field) return;
  at.setAttribute("aria-invalid", "true");
  at.setAttribute("aria-describedby", note.id);
  at.focus();
}

function download(form, name, content) {
  const link = make("a", { href: URL.createObjectURL(content), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  const done = make("p", { className: "notice", textContent: form.dataset.downloaded, tabIndex: -1 });
  done.setAttribute("role", "status");
  form.replaceWith(done);
  done.focus();
}

const KEEPALIVE_BYTES = 60000; // browsers allow 64 KiB

async function send(form, submitter) {
  announce("");
  announce("");
  document.getElementById("refused")?.remove();
  for (const field of all("[aria-invalid]", form)) for (const name of ["aria-invalid", "aria-describedby"]) field.removeAttribute(name);
  const data = new FormData(form, submitter);
  form.querySelector("[data-question]")?.remove();
  if (submitter) submitter.disabled = true;
  try {
    const body = form.enctype === "multipart/form-data" ? data : new URLSearchParams(data);
    const keepalive = body !== data && String(body).length < KEEPALIVE_BYTES; // sent although another form's answer replaces the page meanwhile
    const answer = await fetch(submitter?.getAttribute("formaction") ?? form.getAttribute("action"), { method: "POST", body, keepalive, headers: { Accept: "application/problem+json" } });
    if (answer.ok) {
      const [, file] = /^attachment; filename="([^"]+)"/.exec(answer.headers.get("Content-Disposition")) ?? [];
      if (file) { download(form, file, await answer.blob()); return; }
      const question = form.matches("[data-drop]") && new DOMParser().parseFromString(await answer.text(), "text/html").querySelector("[data-question]");
      if (question) {
        form.prepend(question);
        if (submitter) submitter.disabled = false;
        return;
      }
      try { sessionStorage.setItem("saved", form.dataset.saved); } catch { /* storage is disabled */ }
      const [page] = location.href.split("#"), [shown] = answer.url.split("#");
      location.assign(answer.url);
      if (shown === page) location.reload();
      return;
    }
    const problem = await answer.json();
    refuse(form, problem.detail, problem.errors?.[0]?.pointer);
  } catch {
    refuse(form, "The server did not answer. Try again.");
  }
  if (submitter) submitter.disabled = false;
}

for (const form of all("form[data-drop]")) {
  const input = form.querySelector('input[type="file"]');
  form.addEventListener("dragover", event => { event.preventDefault(); form.classList.add("over"); });
  form.addEventListener("dragleave", () => form.classList.remove("over"));
  form.addEventListener("drop", event => {
    event.preventDefault();
    form.classList.remove("over");
    document.getElementById("refused")?.remove();
    if (event.dataTransfer.files.length === 1) input.files = event.dataTransfer.files;
    else refuse(form, "Drop one file.");
  });
}

function limit(select) {
  const most = select.selectedOptions[0]?.dataset.max;
  if (most === undefined) return;
  select.form.elements[select.dataset.limits].max = most;
  select.form.querySelector("[data-limit]").textContent = `of ${most}`;
}

// ---- comments on lines

function pickLine(line) {
  const form = document.querySelector("form[data-lines]");
  if (!form || !line || !getSelection().isCollapsed) return;
  form.elements.cell.value = line.closest("[data-cell]").dataset.cell;
  form.elements.line.value = line.dataset.line;
  form.closest("details").open = true;
  form.classList.add("picked");
  form.elements.comment.focus({ preventScroll: true });
}

// ---- links into closed details

function reveal() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  let closed = false;
  for (let at = target?.closest("details:not([open])"); at; at = at.parentElement.closest("details:not([open])")) closed = at.open = true;
  if (closed) target.scrollIntoView();
}

// ---- tokens in a link: what follows # is not sent to the server

function fillToken(field) {
  const token = new URLSearchParams(location.hash.slice(1)).get("token");
  if (!token) return;
  field.value = token;
  history.replaceState(null, "", location.pathname + location.search);
  (all("input", field.form).find(one => one.required && !one.value) ?? field.form.querySelector("button.main")).focus();
}

// ---- initialization

function prepare(root) {
  for (const one of all("[data-js]", root)) one.hidden = false;
  for (const select of all("select[data-limits]", root)) limit(select);
  for (const table of all("table[data-grid]", root)) enterGrid(table);
  for (const row of all("[data-rows] > tbody > tr, [data-rows] > li", root)) row.tabIndex = -1;
  for (const list of all("[data-rows]", root)) {
    const first = list.querySelector(":scope > tbody > tr, :scope > li");
    if (first && !list.matches("[data-grid]")) first.tabIndex = 0;
  }
  for (const image of all("img[data-reload]", root)) {
    const again = () => { if (image.isConnected) reloadPart(document.getElementById(image.dataset.reload)); };
    image.addEventListener("load", again);
    image.addEventListener("error", () => setTimeout(again, 5000));
    if (image.complete && image.naturalWidth) again();
  }
  const motions = all("canvas[data-motion]", root);
  if (motions.length) import("./player.js").then(player => motions.forEach(player.play));
}

document.body.append(help);
document.addEventListener("keydown", onKeydown);
document.addEventListener("click", event => { if (!event.target.closest("a")) pickLine(event.target.closest("[data-cell] [data-line]")); });
document.addEventListener("input", event => { if (event.target.matches?.("input[data-filter]")) filter(event.target); });
document.addEventListener("change", event => { if (event.target.matches?.("select[data-limits]")) limit(event.target); });
document.addEventListener("submit", event => {
  const question = event.submitter?.dataset.confirm;
  if (question && !confirm(question)) event.preventDefault();
  else if (event.target.matches("form[data-saved]")) { event.preventDefault(); send(event.target, event.submitter); }
});
const bar = document.querySelector("header nav");
if (bar) {
  const button = make("button", { type: "button", className: "keys", textContent: "?", title: "Help" });
  button.setAttribute("aria-label", "Help");
  button.addEventListener("click", showKeys);
  bar.append(button);
}
try { announceSaved(sessionStorage.getItem("saved") ?? ""); sessionStorage.removeItem("saved"); } catch { /* storage is disabled */ }
prepare(document);
addEventListener("hashchange", reveal);
reveal();
for (const element of all("[data-live][id]")) live(element);
for (const field of all("input[data-token]")) fillToken(field);
