// A cell of the page: its code, its output, and its kind.
import { Edits } from "./edits.js";
import { createEditor } from "./editor.js";
import { after, element, save } from "./elements.js";
import { Now } from "./now.js";

const LINES = 500;
const SILENT = "computes without a pause, or waits for a thread, so it gets neither messages nor Ctrl-C. Stop ends it.";
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
    this.head = node.querySelector(".cell-head");
    // The code that completes a program shown in pieces, how to start it, and how long to wait for its output.
    this.about = JSON.parse(this.head.dataset.run ?? "{}");
    const code = node.querySelector(".cell_input pre, .highlight pre");
    this.recorded = node.querySelector(".cell_output");
    const language = this.kind === "node" || this.kind === "snippet" ? "python" : "";
    this.editor = createEditor(code, this.file || "this cell", language, this.about.before);
    this.written = this.editor.written;
    // A chapter may show a changed version of a program again: each keeps its own edits.
    const before = [...cells.values()].filter((cell) => cell.name === this.name).length;
    this.key = `${location.pathname}#${before ? `${this.name}-${before + 1}` : this.name}`;
    this.now = new Now(this.head, this.name);
  }

  // Show the reader's draft, if there is one, and follow it.
  edit() {
    this.edits = new Edits(this.editor, this.key, this.name, this.node.querySelector(".places"), this.head);
    this.node.querySelector(".cell-links").prepend(this.edits.badge);
    this.edits.onrestore = () => this.#showRecorded();
    // What is saved is what is shown.
    this.node.querySelector(".cell-download")?.addEventListener("click", (event) => {
      if (this.source === this.written) return;
      event.preventDefault();
      save(this.file, (this.about.before ?? "") + this.source);
    });
  }

  // What it does now, in words.
  get state() {
    return this.now.state.textContent;
  }

  get source() {
    return this.editor.text;
  }

  // What the bar calls it: its file, otherwise how its last line begins.
  get title() {
    return this.file || this.source.trim().split("\n").at(-1).split(/\s+/, 3).join(" ") || this.name;
  }

  get program() {
    const { before = "", start } = this.about;
    const call = start ? `\n\nfrom spinbook.kernel import entry as _entry\n_entry.start(globals(), ${JSON.stringify(start)})\n` : "";
    return before + this.source + call;
  }

  #showRecorded() {
    this.shown?.remove();
    this.shown = null;
    if (!this.now.stop) this.now.clear();
    if (this.recorded) this.recorded.hidden = false;
  }

  // A new element for output, instead of the recorded one.
  clear() {
    this.shown?.remove();
    if (this.recorded) this.recorded.hidden = true;
    this.output = element("pre", { tabIndex: 0, role: "log", ariaLabel: `Output of ${this.name}` });
    this.shown = element("div", { className: "ran" }, this.output);
    this.node.append(this.shown);
    this.edits.note("run");
    this.edits.reset.hidden = false;
    this.now.begin();
    this.turn = ++turns;
    this.count = 0;
    this.failed = false;
    this.until = this.about.until;
    this.seen = new Promise((resolve) => (this.see = resolve));
  }

  say(text, phase) {
    this.now.say(text, phase);
  }

  print(text, stream = "stdout") {
    const line = element("span", { className: `stream-${stream}`, textContent: `${text}\n` });
    this.output.append(line);
    this.now.line(text);
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
    this.now.phase("failed");
    if (text) this.print(text, "stderr");
  }

  // Wait until the output contains the text that the chapter names, or for as long as the chapter shows output (s).
  shows(seconds) {
    return Promise.race([this.seen, after(1000 * (this.about.seconds ?? seconds))]);
  }

  // What to do with the messages of a process.
  hears(name) {
    return {
      progress: (part) => this.say(`Starting: ${part} …`),
      output: (text, stream) => {
        logs.set(name, [...(logs.get(name) ?? []), text].slice(-LINES));
        this.print(text, stream);
      },
      silent: (is) =>
        this.say(is ? `${name} ${SILENT}` : `${name} runs.`, "running"),
    };
  }
}

export function cellAt(node) {
  if (!cells.has(node)) cells.set(node, new Cell(node));
  return cells.get(node);
}

// The cell that belongs to a module of the chapter, as `ros2 run` in the cell `from` names it. A chapter may show several
// versions of it: the newest above counts, and once that has run, the version that was run last.
export function cellOf(from, name, full = "") {
  const versions = [...cells.values()].filter((cell) => cell.kind === "node" && (cell.name === name || cell.about.executables?.includes(full)));
  const isAbove = (cell) => cell.node.compareDocumentPosition(from.node) & Node.DOCUMENT_POSITION_FOLLOWING;
  const newest = versions.filter(isAbove).at(-1) ?? versions[0];
  return newest?.turn ? versions.reduce((last, cell) => ((cell.turn ?? 0) > last.turn ? cell : last), newest) : newest;
}
