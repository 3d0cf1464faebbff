// A cell of the page: its code, its output, and its kind.
import { createEditor } from "./editor.js";
import { button, element } from "./elements.js";

const LINES = 500;
const KINDS = ["node", "shell", "snippet", "interface", "package_file"];

export const cells = new Map();
// How many cells have been run.
let turns = 0;
// What each node has printed, for %log.
export const logs = new Map();

class Cell {
  constructor(node) {
    this.node = node;
    this.file = node.querySelector(".cell-file")?.textContent ?? "";
    this.kind = KINDS.find((kind) => node.classList.contains(`cell-${kind}`));
    this.name = this.file.replace(/\.py$/, "") || `cell ${cells.size + 1}`;
    // The code that completes a program shown in pieces, how to start it, and how long to wait for its output.
    this.about = JSON.parse(node.querySelector(".cell-head").dataset.run ?? "{}");
    this.code = node.querySelector(".cell_input pre, .highlight pre");
    this.recorded = node.querySelector(".cell_output");
    this.links = node.querySelector(".cell-links");
    const language = this.kind === "node" || this.kind === "snippet" ? "python" : "";
    // A chapter may show a changed version of a program again: each keeps its own edits.
    const before = [...cells.values()].filter((cell) => cell.name === this.name).length;
    const own = before ? `${this.name}-${before + 1}` : this.name;
    this.editor = createEditor(this.code, `${location.pathname}#${own}`, this.file || "this cell", language);
    this.reset = button("Reset", `Reset ${this.name}`, () => this.restore());
    this.reset.hidden = !this.editor.changed;
    this.editor.onchange = () => (this.reset.hidden = false);
    this.links.prepend(this.reset);
  }

  get source() {
    return this.editor.text;
  }

  get program() {
    const { before = "", start } = this.about;
    const call = start ? `\n\nfrom spinbook.kernel import entry as _entry\n_entry.start(globals(), ${JSON.stringify(start)})\n` : "";
    return before + this.source + call;
  }

  // Restore the page's own code and its recorded output.
  restore() {
    this.editor.restore();
    this.shown?.remove();
    this.shown = null;
    if (this.recorded) this.recorded.hidden = false;
    this.reset.hidden = true;
  }

  // A new element for output, instead of the recorded one.
  clear() {
    this.shown?.remove();
    if (this.recorded) this.recorded.hidden = true;
    this.output = element("pre", { tabIndex: 0 });
    this.output.setAttribute("role", "log");
    this.output.setAttribute("aria-label", `Output of ${this.name}`);
    this.state = element("p", { className: "run-state" });
    this.state.setAttribute("role", "status");
    this.shown = element("div", { className: "ran" }, this.state, this.output);
    this.node.append(this.shown);
    this.reset.hidden = false;
    this.turn = ++turns;
    this.count = 0;
    this.failed = false;
    this.until = this.about.until;
    this.seen = new Promise((resolve) => (this.see = resolve));
  }

  say(text) {
    if (this.state.textContent !== text) this.state.textContent = text;
  }

  print(text, stream = "stdout") {
    const line = element("span", { className: `stream-${stream}`, textContent: `${text}\n` });
    this.output.append(line);
    if (++this.count > LINES) this.output.firstChild.remove();
    this.output.scrollTop = this.output.scrollHeight;
    if (this.until && text.includes(this.until)) this.see();
    this.hear?.();
  }

  // Resolves with the next line of output.
  nextLine() {
    return new Promise((resolve) => (this.hear = resolve));
  }

  fail(text) {
    this.failed = true;
    if (text) this.print(text, "stderr");
  }

  // Wait until the output contains the text that the chapter names, or for as long as the chapter shows output (s).
  shows(seconds) {
    return Promise.race([this.seen, new Promise((resolve) => setTimeout(resolve, 1000 * (this.about.seconds ?? seconds)))]);
  }

  // What to do with the messages of a process.
  hears(name) {
    return {
      progress: (part) => this.say(`Loading ${part} …`),
      output: (text, stream) => {
        logs.set(name, [...(logs.get(name) ?? []), text].slice(-LINES));
        this.print(text, stream);
      },
      silent: (is) =>
        this.say(is ? `${name} computes without a pause, or waits for a thread, so it gets neither messages nor Ctrl-C. Stop ends it.` : `${name} runs.`),
    };
  }
}

export function cellAt(node) {
  if (!cells.has(node)) cells.set(node, new Cell(node));
  return cells.get(node);
}

// The cell that belongs to a module of the chapter, as `ros2 run` names it: if there are several, the one run last.
export const cellOf = (name, full = "") =>
  [...cells.values()]
    .filter((cell) => cell.kind === "node" && (cell.name === name || cell.about.executables?.includes(full)))
    .sort((a, b) => (b.turn ?? 0) - (a.turn ?? 0))[0];
