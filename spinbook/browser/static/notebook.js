// Plain cells, terminals and interfaces. They share one process, which starts with the first of these cells.
import { runExecutable, showLog, showNodes, showTurtle, stop } from "./nodes.js";
import { launch } from "./launch.js";
import { graph, show } from "./picture.js";
import { Process, environment } from "./processes.js";
import { timeline } from "./timeline.js";
import { files, keep } from "./workspace.js";

const SHOWN_S = 6;
const GRAPH_S = 2.5;
const LONGEST_S = 60;
// How long a command may take to begin.
const START_S = 4;
const ENDLESS = /^ros2 (topic (echo|hz|bw|delay|pub)|service echo)\b/;
const SHOWS_ONLY = / (-s|--show-arg(ument)?s|-h|--help)( |$)/;
const BOUNDED = / (--once|-1|--times|-t) /;

let shared = null;

// Return the shared process; its output goes to this cell.
async function sharedProcess(cell) {
  if (!shared || shared.gone) shared = new Process("notebook", { end: () => (shared.gone = true) });
  const { progress } = cell.hears("");
  Object.assign(shared.hears, { progress, output: (text, stream) => cell.print(text, stream) });
  await shared.ready;
  await shared.call("environment", { environment });
  cell.say("");
  return shared;
}

// Return the shared process, for drawing the graph. This works while a cell runs, too.
export async function observer() {
  if (!shared || shared.gone) shared = new Process("notebook", { end: () => (shared.gone = true) });
  await shared.ready;
  return shared;
}

// Let the shared process do something for a cell; the bar can stop it.
async function busy(cell, process, op, given) {
  process.work(cell.name);
  try {
    const status = await process.call(op, given);
    if (status === null) cell.fail(cell.say("It was ended, so the variables of the cells above are lost. Run those cells again."));
    else if (status) cell.failed = true;
    return status;
  } finally {
    process.work("");
  }
}

export async function runPlain(cell) {
  const process = await sharedProcess(cell);
  for (const part of parts(cell.source)) {
    if (part.magic) await magic(cell, process, part.magic);
    else await busy(cell, process, "python", { source: part.python });
    if (cell.failed) return;
  }
}

// Split a plain cell: lines such as `%stop left_toe` are for the page, the rest is Python.
function parts(source) {
  const pieces = [];
  let python = [];
  const finish = () => {
    if (python.join("").trim()) pieces.push({ python: python.join("\n") });
    python = [];
  };
  for (const line of source.split("\n")) {
    if (!/^%\w/.test(line)) {
      python.push(line);
      continue;
    }
    finish();
    pieces.push({ magic: wordsOf(line.slice(1)) });
  }
  finish();
  return pieces;
}

// The words of a line, quoted as in a shell.
const wordsOf = (line) => (line.match(/"[^"]*"|'[^']*'|\S+/g) ?? []).map((word) => word.replace(/^(["'])(.*)\1$/, "$2"));

async function magic(cell, process, [word, ...args]) {
  const known = { nodes: showNodes, log: showLog, stop, turtle: showTurtle, env: setVariable };
  if (word in known) await known[word](cell, args);
  else if (word === "timeline") await timeline(cell, process, args);
  else if (word === "plot") await drawPlot(cell, process, args);
  else if (word === "graph") await drawGraph(cell, process, args);
  else if (word === "ros2") await runCommand(cell, process, { kind: "ros2", words: ["ros2", ...args], text: `ros2 ${args.join(" ")}` });
  else cell.fail(`%${word} does not work in a page. It works in the notebook.`);
}

// `%env NAME=VALUE`, `%env NAME VALUE`, `%env NAME`, `%env`, and a terminal's `export`: for processes started later.
function setVariable(cell, args) {
  const [name, ...rest] = args.join(" ").split(/[=\s]+/);
  if (!name) return Object.entries(environment).forEach(([key, value]) => cell.print(`${key}=${value}`));
  if (rest.length === 0) return cell.print(environment[name] ?? "");
  environment[name] = rest.join(" ").replace(/^(["'])(.*)\1$/, "$2");
  cell.print(`env: ${name}=${environment[name]}`);
}

async function drawPlot(cell, process, args) {
  const { words: paths, seconds = cell.about.seconds ?? SHOWN_S, title = "" } = optionsOf(args);
  cell.say(`Recording for ${seconds} s …`);
  const drawn = await process.call("plot", { paths, seconds: Number(seconds), title });
  cell.say("");
  if (drawn) show(cell, drawn, "live-plot");
}

// Split `/a/x --seconds 3` into words and options by name.
function optionsOf(args) {
  const options = { words: [] };
  for (let at = 0; at < args.length; at += 1) {
    if (args[at].startsWith("--")) options[args[at].slice(2)] = args[(at += 1)];
    else options.words.push(args[at]);
  }
  return options;
}

async function drawGraph(cell, process, args) {
  const seconds = Number(optionsOf(args).seconds ?? GRAPH_S);
  cell.say(`Counting messages for ${seconds} s …`);
  const counted = await process.call("count", { seconds });
  cell.say("");
  if (counted?.pictures.length) cell.shown?.append(graph(counted));
  else cell.print("No node runs. Run one.");
}

export async function runTerminal(cell) {
  const process = await sharedProcess(cell);
  for (const command of await process.call("commands", { source: cell.source })) {
    await runCommand(cell, process, command);
    if (cell.failed) return;
  }
}

async function runCommand(cell, process, command) {
  const { kind, words, text, why } = command;
  const exported = /^# export (\w+=.*)/.exec(text);
  if (why) cell.print(`${text}\n    does not run in a page: ${why}.`, "stderr");
  else if (exported) setVariable(cell, [exported[1]]);
  else if (kind === "rqt_plot") await drawPlot(cell, process, words.slice(1));
  else if (kind === "rqt_graph") await drawGraph(cell, process, []);
  else if (kind === "colcon") cell.print("colcon is not needed in a page: `ros2 run` finds the page's nodes without it.");
  else if (kind === "ros2" && words[1] === "run") await runExecutable(cell, words);
  else if (kind === "ros2" && words[1] === "launch" && !SHOWS_ONLY.test(text)) await launch(cell, process, text);
  else if (kind === "ros2") await bounded(cell, process, text);
}

// Run a command. Endless output ends after a while, as in the notebook, or once it contains the text that the chapter names.
// The seconds count from the first line, so that a slow computer shows as much as a fast one.
async function bounded(cell, process, line) {
  const endless = ENDLESS.test(line) && !BOUNDED.test(`${line} `);
  const seconds = cell.about.seconds ?? (endless ? SHOWN_S : LONGEST_S);
  let interrupted = false;
  let over = false;
  const interrupt = () => {
    interrupted = true;
    process.signal("SIGINT");
  };
  const atMost = cell.about.seconds ? seconds + START_S : seconds;
  let timer = setTimeout(interrupt, 1000 * atMost);
  cell.nextLine().then(() => {
    if (over) return;
    clearTimeout(timer);
    timer = setTimeout(interrupt, 1000 * seconds);
  });
  if (cell.until) cell.seen.then(() => over || interrupt());
  try {
    const status = await busy(cell, process, "command", { source: line, files: files() });
    if (interrupted && status !== null) cell.failed = false;
  } finally {
    over = true;
    clearTimeout(timer);
  }
}

export async function runFile(cell) {
  cell.print(`Wrote ${keep(cell.file, cell.source)}`);
  cell.say("");
}

export async function runInterface(cell) {
  const process = await sharedProcess(cell);
  await busy(cell, process, "define", { name: cell.file, text: cell.source });
}
