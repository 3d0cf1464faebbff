// Runs the cells of a page: one, or all those above one.
import { bar } from "./bar.js";
import { cellAt } from "./cell.js";
import { download } from "./download.js";
import { announce, failure, hindrance, style } from "./elements.js";
import { runFile, runInterface, runPlain, runTerminal } from "./notebook.js";
import { runNode } from "./nodes.js";

// How long a notebook shows a node's log before it goes on (s).
const NODE_S = 3;
const RUNNABLE = "main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)";

const nodesOf = () => [...document.querySelectorAll(RUNNABLE)];

// Prepare the cells of a page: each can be edited from now on.
export function open() {
  style();
  bar();
  nodesOf().forEach(cellAt);
}

const runs = { shell: runTerminal, snippet: runPlain, interface: runInterface, package_file: runFile };

// Run one cell. Resolves when a plain cell or a command has ended, or when a node has started.
export async function run(node) {
  open();
  const cell = cellAt(node);
  cell.clear();
  const hindered = hindrance();
  if (hindered) return void cell.fail(cell.say(hindered));
  cell.say("Starting …");
  node.setAttribute("aria-busy", "true");
  try {
    await download((text) => cell.say(text));
    await (runs[cell.kind] ?? runNode)(cell);
  } catch (error) {
    cell.say(failure(error));
    cell.fail(error.message);
  } finally {
    node.removeAttribute("aria-busy");
    announce(`${cell.name}: ${cell.state.textContent || "done"}`);
  }
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
      announce(`Stopped at ${cell.name}, which failed.`);
      return;
    }
  }
  node.scrollIntoView({ block: "nearest" });
  announce(`Ran ${above.length} cells above.`);
}
