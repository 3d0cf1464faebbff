// Runs the cells of a page: output under each, a bar that shows which nodes run, and the code to change.
import { editing } from "./editing.js";
import { plot } from "./plot.js";
import { Process, named, running } from "./processes.js";
import { turtle } from "./turtle.js";

const LINES = 500;
const LOOK_S = 6;
const LONGEST_S = 60;
const TOO_OLD =
  "This browser can't run nodes: it lacks JavaScript Promise Integration. Chrome and Edge 137 or newer and " +
  "Firefox 153 or newer have it. The outputs on this page are recorded from real nodes.";
const FROM_FILE =
  "Nodes can't run in a page that is opened from a file. Open this course on its website, or put it on any web server.";

const said = document.getElementById("said");
const cells = new Map();
const logs = new Map();
let shared = null;

// What a page can't do, in one sentence, or "".
export function hindrance() {
  if (location.protocol === "file:") return FROM_FILE;
  return typeof WebAssembly === "object" && "Suspending" in WebAssembly ? "" : TOO_OLD;
}

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function button(text, label, act) {
  const made = element("button", { type: "button", className: "run-button", textContent: text });
  made.setAttribute("aria-label", label);
  made.addEventListener("click", act);
  return made;
}

class Cell {
  constructor(node) {
    this.node = node;
    this.file = node.querySelector(".cell-file")?.textContent ?? "";
    this.kind = ["node", "shell", "snippet"].find((kind) => node.classList.contains(`cell-${kind}`));
    this.name = this.file.replace(/\.py$/, "") || `cell ${cells.size + 1}`;
    // What makes the code a whole program, where the chapter shows it in pieces.
    this.run = JSON.parse(node.querySelector(".cell-head").dataset.run ?? "{}");
    this.code = node.querySelector(".cell_input pre, .highlight pre");
    this.recorded = node.querySelector(".cell_output");
    this.links = node.querySelector(".cell-links");
    this.editor = editing(this.code, `${location.pathname}#${this.name}`, this.file || "this cell");
    this.reset = button("Reset", `Reset ${this.name}`, () => this.restore());
    this.reset.hidden = !this.editor.changed;
    this.editor.onchange = () => (this.reset.hidden = false);
    this.links.prepend(this.reset);
  }

  get source() {
    return this.editor.text;
  }

  get program() {
    const { before = "", start } = this.run;
    const call = start ? `\n\nfrom spinbook.runtime import entry as _entry\n_entry.start(globals(), ${JSON.stringify(start)})\n` : "";
    return before + this.source + call;
  }

  restore() {
    this.editor.restore();
    this.shown?.remove();
    this.shown = null;
    if (this.recorded) this.recorded.hidden = false;
    this.reset.hidden = true;
  }

  // A new place for output, instead of the recorded one.
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
    this.count = 0;
  }

  say(text) {
    this.state.textContent = text;
  }

  print(text, stream = "stdout") {
    const line = element("span", { className: `stream-${stream}`, textContent: `${text}\n` });
    this.output.append(line);
    if (++this.count > LINES) this.output.firstChild.remove();
    this.output.scrollTop = this.output.scrollHeight;
  }

  hears(name) {
    return {
      progress: (part) => this.say(`Loading ${part} …`),
      output: (text, stream) => {
        logs.set(name, [...(logs.get(name) ?? []), text].slice(-LINES));
        this.print(text, stream);
      },
      end: bar,
    };
  }
}

// The cell that belongs to a module of the chapter, as `ros2 run` names it.
const cellOf = (name, full = "") =>
  [...cells.values()].find((cell) => cell.kind === "node" && (cell.name === name || cell.run.executables?.includes(full)));

async function runNode(cell, into = cell, args = []) {
  await named(cell.name)?.stop();
  logs.delete(cell.name);
  const process = new Process(cell.name, into.hears(cell.name));
  const ended = process.program(cell.program, cell.file, args);
  bar();
  await process.ready;
  into.say(`${cell.name} runs.`);
  ended.then((status) => into.say(status === null ? `${cell.name} was ended.` : `${cell.name} ended with ${status}.`));
  return ended;
}

// Plain cells and commands share one process, which starts with the first of them.
async function sharedProcess(cell) {
  if (!shared || shared.gone) {
    shared = new Process("notebook", { end: () => (shared.gone = true) });
  }
  Object.assign(shared.hears, { progress: cell.hears("").progress, output: (text, stream) => cell.print(text, stream) });
  await shared.ready;
  cell.say("");
  return shared;
}

async function runCell(cell) {
  const process = await sharedProcess(cell);
  for (const part of parts(cell.source)) {
    if (part.magic) await magic(cell, process, part.magic);
    else await process.call("python", { source: part.python });
  }
}

// A plain cell's lines: `%stop left_toe` is for the page, the rest is Python.
function parts(source) {
  const found = [];
  let python = [];
  for (const line of source.split("\n")) {
    if (line.startsWith("%")) found.push({ magic: line.slice(1).trim().split(/\s+/) });
    else python.push(line);
  }
  if (python.join("").trim()) found.push({ python: python.join("\n") });
  return found;
}

async function magic(cell, process, [word, ...args]) {
  if (word === "nodes") showNodes(cell);
  else if (word === "log") for (const line of logs.get(args[0]) ?? []) cell.print(line);
  else if (word === "stop") await stop(cell, args);
  else if (word === "turtle") showTurtle(cell);
  else if (word === "plot") await drawPlot(cell, process, args);
  else cell.print(`%${word} does not work in a page. It works in the notebook.`, "stderr");
}

function showNodes(cell) {
  if (running().length === 0) cell.print("No node runs.");
  for (const { name } of running()) {
    const count = logs.get(name)?.length ?? 0;
    cell.print(`${name.padEnd(28)} running     ${String(count).padStart(12)} line${count === 1 ? "" : "s"} logged`);
  }
}

async function stop(cell, names) {
  const wanted = running().filter((node) => names.length === 0 || names.includes("--all") || names.includes(node.name));
  await Promise.all(wanted.map((node) => node.stop()));
  for (const node of wanted) cell.print(`${node.name} stopped.`);
}

async function drawPlot(cell, process, args) {
  const at = args.indexOf("--seconds");
  const seconds = at >= 0 ? Number(args[at + 1]) : LOOK_S;
  const topics = args.filter((word, index) => !word.startsWith("--") && (at < 0 || index !== at + 1));
  cell.say(`Recording for ${seconds} s …`);
  const lines = await process.call("record", { topics, seconds });
  cell.say("");
  cell.shown.append(plot(lines, seconds));
}

async function runTerminal(cell) {
  const process = await sharedProcess(cell);
  for (const line of cell.source.replace(/\\\n/g, " ").split("\n")) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "rqt_plot") await drawPlot(cell, process, words.slice(1));
    else if (words[0] === "ros2" && words[1] === "run") await runExecutable(cell, words);
    else if (words[0] === "ros2") await bounded(cell, process, line);
    else if (line.trim() && !/^(#|cd|source|export)\b/.test(line.trim())) cell.print(`${words[0]} does not run in a page.`, "stderr");
  }
}

async function runExecutable(cell, words) {
  if (words[3] === "turtlesim_node") return void (await runTurtlesim(cell, words.slice(4)));
  const wanted = cellOf(words[3], `${words[2]}/${words[3]}`);
  if (!wanted) return void cell.print(`There is no node ${words[3]} on this page.`, "stderr");
  const args = words.slice(4);
  await Promise.race([runNode(wanted, cell, args), new Promise((resolve) => setTimeout(resolve, 1000 * LOOK_S))]);
}

const TURTLESIM =
  "import sys\nfrom spinbook.browser.in_page import canvas\ncanvas.use()\n" +
  "from spinbook.turtlesim.node import main\nsys.exit(main())\n";

async function runTurtlesim(cell, args) {
  await named("turtlesim_node")?.stop();
  logs.delete("turtlesim_node");
  const process = new Process("turtlesim_node", cell.hears("turtlesim_node"));
  process.program(TURTLESIM, "turtlesim_node.py", args);
  bar();
  await process.ready;
  cell.say("turtlesim_node runs. Look at it with %turtle.");
}

function showTurtle(cell) {
  const node = named("turtlesim_node");
  if (node) cell.shown.append(turtle(node.ended));
  else cell.print("turtlesim does not run: ros2 run turtlesim turtlesim_node", "stderr");
}

// What does not end by itself is ended after a while, as in the notebook.
async function bounded(cell, process, line) {
  const goesOn = /^ros2 topic (echo|hz|bw|delay|pub)\b/.test(line) && !/ (--once|-1|--times|-t) /.test(`${line} `);
  const timer = setTimeout(() => process.signal("SIGINT"), 1000 * (goesOn ? LOOK_S : LONGEST_S));
  try {
    await process.call("command", { source: line });
  } finally {
    clearTimeout(timer);
  }
}

let place = null;

function bar() {
  place ??= document.body.appendChild(element("div", { className: "running" }));
  place.setAttribute("role", "region");
  place.setAttribute("aria-label", "Running nodes");
  const nodes = running();
  place.hidden = nodes.length === 0;
  const stops = nodes.map((node) =>
    element("li", {}, element("span", { textContent: node.name }), button("Stop", `Stop ${node.name}`, () => node.stop())),
  );
  const every = button("Stop all", "Stop all nodes", () => Promise.all(running().map((node) => node.stop())));
  place.replaceChildren(element("span", { className: "running-title", textContent: "Running" }), element("ul", {}, ...stops), every);
}

function cellAt(node) {
  if (!cells.has(node)) cells.set(node, new Cell(node));
  return cells.get(node);
}

// The page's style sheet for all this, once.
export function style() {
  if (document.querySelector("link[data-run]")) return;
  const sheet = element("link", { rel: "stylesheet", href: new URL("run.css", import.meta.url).href });
  sheet.dataset.run = "";
  document.head.append(sheet);
}

// Get the cells of a page ready: each can be changed from now on.
export function open() {
  style();
  for (const node of document.querySelectorAll("main .cell:is(.cell-node, .cell-shell, .cell-snippet)")) cellAt(node);
}

// Run one cell. Resolves when a plain cell or a command has ended, or when a node has started.
export async function run(node) {
  open();
  const cell = cellAt(node);
  cell.clear();
  const hindered = hindrance();
  if (hindered) return cell.say(hindered);
  cell.say("Starting …");
  node.setAttribute("aria-busy", "true");
  try {
    if (cell.kind === "node") {
      const ended = runNode(cell);
      await Promise.race([ended, new Promise((resolve) => setTimeout(resolve, 500))]);
      await named(cell.name)?.ready;
    } else if (cell.kind === "shell") await runTerminal(cell);
    else await runCell(cell);
  } catch (error) {
    cell.say("It could not run here. Is there enough memory? Stop a node, or reload the page.");
    cell.print(error.message, "stderr");
  } finally {
    node.removeAttribute("aria-busy");
    said.textContent = `${cell.name}: ${cell.state.textContent || "done"}`;
  }
}
