// Runs the cells of a page: one, or all those above one.
import { bar } from "./bar.js";
import { cellAt, cells } from "./cell.js";
import { download } from "./download.js";
import { forget, settle } from "./drafts.js";
import { announce, button, element, failure, hindrance, style } from "./elements.js";
import { runFile, runInterface, runPlain, runTerminal } from "./notebook.js";
import { runNode } from "./nodes.js";
import { tellUpdate } from "./update.js";

// How long a notebook shows a node's log before it goes on (s).
const NODE_S = 3;
const RUNNABLE = "main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)";

const nodesOf = () => [...document.querySelectorAll(RUNNABLE)];

// Prepare the cells of a page: each shows the reader's draft, and can be edited from now on.
export function open() {
  if (cells.size) return;
  style();
  bar();
  const all = nodesOf().map(cellAt);
  const homeless = settle(`${location.pathname}#`, all);
  for (const cell of all) {
    cell.edit();
    cell.editor.onrun = () => run(cell.node);
  }
  homeless.forEach(([key, draft]) => document.querySelector("main h1").after(offer(key, draft)));
}

// Edit the code of a cell, at a point of the window.
export function edit(node, point) {
  open();
  cellAt(node).editor.open(point);
}

// Return a note about a draft whose cell the course no longer has.
function offer(key, { text }) {
  const name = key.slice(key.indexOf("#") + 1);
  const note = element("details", { className: "homeless" });
  const remove = button("Delete", `Delete your ${name}`, () => (forget(key), note.remove()));
  const words = element("summary", { textContent: `The course no longer has a cell that you have edited (${name}). Show your code` });
  note.append(words, element("pre", { textContent: text, tabIndex: 0 }), remove);
  return note;
}

const runs = { shell: runTerminal, snippet: runPlain, interface: runInterface, package_file: runFile };

// Cells that are to run again once they have ended: Run was pressed while they were busy.
const again = new WeakSet();

// Run one cell. Resolves when a plain cell or a command has ended, or when a node has started.
export async function run(node) {
  open();
  const cell = cellAt(node);
  const busy = () => node.hasAttribute("aria-busy");
  // What is starting need not start twice.
  if (busy() && cell.source === cell.begun && (cell.kind === "node" || cell.now.starts)) return;
  if (busy()) again.add(node);
  const begun = cell.turn;
  if (cell.kind !== "node") await cell.now.stop?.();
  if (busy() || cell.turn !== begun) return;
  node.setAttribute("aria-busy", "true");
  cell.begun = cell.source;
  cell.clear();
  cell.say("Starting …");
  // The head has grown: show all of it above the bar.
  cell.head.scrollIntoView({ block: "nearest", behavior: "instant" });
  try {
    const hindered = hindrance();
    if (hindered) return void cell.fail(cell.say(hindered));
    tellUpdate();
    await download((text, part) => (cell.say(text), cell.now.progress(part)));
    await (runs[cell.kind] ?? runNode)(cell);
  } catch (error) {
    cell.fail(cell.say(failure(error)));
  } finally {
    node.removeAttribute("aria-busy");
    cell.now.close(cell.failed);
    announce(`${cell.name}: ${cell.state}`);
  }
  if (again.delete(node)) await run(node);
}

// Run the cells above this one, in order, and wait for each as a notebook does. Stops at one that fails unexpectedly.
export async function runAbove(node) {
  const above = nodesOf().slice(0, nodesOf().indexOf(node));
  for (const each of above) {
    each.scrollIntoView({ block: "nearest" });
    await run(each);
    const cell = cellAt(each);
    if (cell.kind === "node" && !cell.failed) await Promise.race([cell.shows(NODE_S), cell.ended]);
    if (cell.failed && !cell.about.raises) {
      // It may be in a part of the chapter that is not shown.
      each.dispatchEvent(new Event("beforematch", { bubbles: true }));
      each.scrollIntoView({ block: "nearest" });
      announce(`Stopped at ${cell.name}, which failed.`);
      return;
    }
  }
  node.scrollIntoView({ block: "nearest" });
  announce(`Ran ${above.length} cells above.`);
}
