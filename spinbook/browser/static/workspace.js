// The launch and parameter files that cells of the page have written into the chapter's package.
import { cells } from "./cell.js";

const texts = {};

// The package of the page's nodes.
const pack = () =>
  [...cells.values()].flatMap((cell) => cell.about.executables ?? []).map((name) => name.split("/")[0])[0] ?? "package";

// Write a file; where it lies in the workspace.
export function keep(path, text) {
  texts[path] = `${text.trimEnd()}\n`;
  return `src/${pack()}/${path}`;
}

// All of them, as a process gets them; `more` are files with whole paths.
export const files = (more = {}) => ({ pack: pack(), texts, more });
