// The launch and parameter files that cells of the page have written into the chapter's package.
import { cells } from "./cell.js";

const texts = {};

const NAMED = /\bros2 (?:run|launch) ([a-z]\w+) [\w.]|\bsrc\/([a-z]\w+)\//g;

// Packages that are part of Spinbook.
const OTHERS = /^(turtlesim|demo_nodes_(cpp|py))$/;

// Return the package of the page's nodes, as the chapter's commands name it.
function pack() {
  const text = [...cells.values()].filter((cell) => cell.kind === "shell").map((cell) => cell.source).join("\n");
  const names = [...text.matchAll(NAMED)].map(([, run, path]) => run ?? path).filter((name) => !OTHERS.test(name));
  return names[0] ?? "package";
}

// Write a file; return its path in the workspace.
export function keep(path, text) {
  texts[path] = `${text.trimEnd()}\n`;
  return `src/${pack()}/${path}`;
}

// Return all files, in the form that a process gets; `more` are files with full paths.
export const files = (more = {}) => ({ pack: pack(), texts, more });
