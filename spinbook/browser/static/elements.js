// Building blocks of a running page: elements, buttons, the style sheet, and messages about why something can't run.

const TOO_OLD =
  "This browser can't run nodes: it lacks JavaScript Promise Integration. Chrome and Edge 137 or newer and " +
  "Firefox 153 or newer have it. The outputs on this page are recorded from real nodes.";
const FROM_FILE =
  "Nodes can't run in a page that is opened from a file. Open this course on its website, or put it on any web server.";
export const UPDATED = "This course was updated: reload the page. Your code is kept.";
const NOT_LOADED =
  "It could not be loaded: there is no connection to this course's website, or the website does not answer. " +
  "Check the network, reload the page, and try again.";
const NO_MEMORY = "There is not enough memory for this. Stop a node, close other tabs, or reload the page.";

// Return why this page can't run nodes, in one sentence; "" if it can.
export function hindrance() {
  if (location.protocol === "file:") return FROM_FILE;
  return typeof WebAssembly === "object" && "Suspending" in WebAssembly ? "" : TOO_OLD;
}

// Return what went wrong when something could not start, in one sentence.
export function failure(error) {
  const text = String(error?.message ?? error);
  if (/memory|RangeError|Maximum call stack/i.test(text)) return NO_MEMORY;
  if (/another version|: 404/.test(text)) return UPDATED;
  if (/^(\w+Error: )?(Failed to fetch|NetworkError|Load failed)|dynamically imported|: 5\d\d$|could not start it/i.test(text)) return NOT_LOADED;
  const words = text.split("\n").filter((line) => /^[\w.]+(Error|Exception|Fault)\b/.test(line));
  return `It could not run here: ${words.at(-1) ?? text.split("\n")[0]}`;
}

// Make an element. `properties` may be ARIA's, such as ariaLabel.
export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function button(text, label, act) {
  const made = element("button", { type: "button", className: "run-button", textContent: text, ariaLabel: label });
  made.addEventListener("click", act);
  return made;
}

// Resolves after a while (ms), with `value`.
export const after = (ms, value) => new Promise((resolve) => setTimeout(resolve, ms, value));

// Let the reader save a text as a file.
export function save(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: "text/x-python" }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// Announce to screen readers what has just happened.
export function announce(text) {
  document.getElementById("said").textContent = text;
}

// Add the style sheet of a running page, once.
export function style() {
  if (document.querySelector("link[data-run]")) return;
  const sheet = element("link", { rel: "stylesheet", href: new URL("run.css", import.meta.url).href });
  sheet.dataset.run = "";
  document.head.append(sheet);
}
