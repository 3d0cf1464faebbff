// The launch and parameter files that cells of the page have written into the chapter's package.
import { cells } from "./cell.js";

const texts = {};
const pack = document.documentElement.dataset.package;

// Write a file; return its path in the workspace.
export function keep(path, text) {
  texts[path] = `${text.trimEnd()}\n`;
  return `src/${pack}/${path}`;
}

// Return all files, in the form that a process gets; `more` are files with full paths.
export const files = (more = {}) => ({ pack, texts, more });

// Return the name of a file that a command uses and whose cell has not been run; "" if there is none.
export function notWritten(command) {
  const names = [...cells.values()].filter((cell) => cell.kind === "package_file" && !(cell.file in texts)).map(({ file }) => file.split("/").at(-1));
  return names.find((name) => command.includes(name)) ?? "";
}

// Return why `ros2 launch` can't find the file that it names, although this page has the package or the file; "" otherwise.
export function absentLaunchFile([, verb, name, file = "-"]) {
  if (verb !== "launch" || file.startsWith("-")) return "";
  const names = [...cells.values()].filter((cell) => cell.file.startsWith("launch/")).map((cell) => cell.file.split("/").at(-1));
  if (names.includes(file)) return name === pack ? "" : `Package '${name}' not found. ${file} is in ${pack}.`;
  return name === pack ? `There is no launch file ${file} on this page. There is: ${names.join(", ") || "none"}.` : "";
}
