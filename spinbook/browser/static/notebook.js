// Plain cells, terminals and interfaces. Plain cells share one process, one after another; each terminal has its own.
import { runExecutable, showLog, showNodes, showTurtle, stop } from "./nodes.js";
import { launch } from "./launch.js";
import { read, UsageError } from "./magic_line.js";
import { graph, show } from "./picture.js";
import { environment, take } from "./processes.js";
import { robot } from "./robot.js";
import { timeline } from "./timeline.js";
import { absentLaunchFile, files, keep, notWritten } from "./workspace.js";

const SHOWN_S = 6;
const GRAPH_S = 2.5;
const LONGEST_S = 60;
// How long a command may take to begin.
const START_S = 4;
const ENDLESS = /^ros2 (topic (echo|hz|bw|delay|pub)|service echo)\b/;
const SHOWS_ONLY = / (-s|--show-arg(ument)?s|-h|--help)( |$)/;
const BOUNDED = / (--once|-1|--times|-t) /;

// The process of plain cells, which holds their variables, and the last cell that waits for it.
let shared = null;
let last = Promise.resolve();
// Processes of terminals that have ended their commands: the next terminal takes one.
const idle = [];

// Return the process of plain cells.
export async function observer() {
  if (!shared?.alive) shared = take("notebook", {});
  await shared.ready;
  return shared;
}

// Let a process work for a cell: its output goes there, and the bar, the cell's head and Ctrl-C can end it.
async function workFor(cell, process, act) {
  const { progress } = cell.hears("");
  Object.assign(process.hears, { progress, output: (text, stream) => cell.print(text, stream) });
  process.work(cell.title);
  const stop = () => process.stop();
  cell.now.runs(stop);
  try {
    await process.ready;
    await process.call("cells.set_environment", { environment });
    return await act(process);
  } finally {
    // A node that the command has started goes on.
    if (cell.now.stop === stop) cell.now.runs(null);
    process.work("");
    process.hears.output = () => {};
  }
}

// Let a process that no other cell uses work for this one.
async function inTerminal(cell, act) {
  const process = idle.pop() ?? take("terminal", {});
  try {
    return await workFor(cell, process, act);
  } finally {
    if (process.alive) idle.length ? process.end() : idle.push(process);
  }
}

// Run Python in the process of plain cells, after the cells that were started before.
function inNotebook(cell, act) {
  const run = last.then(async () => workFor(cell, await observer(), act));
  last = run.catch(() => {});
  return run;
}

// Let a process do something; note in the cell how that ended.
async function result(cell, process, op, given) {
  const status = await process.call(op, given);
  if (status === null) cell.fail(cell.say("It was ended."));
  else if (status) cell.fail();
  return status;
}

export async function runPlain(cell) {
  for (const part of parts(cell.source)) {
    if (part.magic) await magic(cell, part.magic, part.rest);
    else await runPython(cell, part.python);
    if (cell.failed) return;
  }
}

async function runPython(cell, source) {
  cell.say("Waiting for the cells before …");
  const status = await inNotebook(cell, (process) => {
    cell.say("Running …", "running");
    return process.call("cells.run_python", { source });
  });
  if (status === null) cell.fail(cell.say("It was ended, so the variables of the cells above are lost. Run those cells again."));
  else if (status) cell.fail();
}

// Split a plain cell: lines such as `%stop left_toe` are for the page, the rest is Python.
function* parts(source) {
  const pieces = source.split(/^(!|%%?\w+)(.*)\n?/m);
  for (let at = 0; at < pieces.length; at += 3) {
    const [python, first, rest] = pieces.slice(at, at + 3);
    if (python.trim()) yield { python };
    if (first) yield { magic: first.replace(/^%/, ""), rest: rest.trim() };
  }
}

// What a page does for each magic; `args` are its words and options.
const MAGICS = {
  nodes: showNodes,
  log: showLog,
  stop,
  turtle: showTurtle,
  timeline: (cell, args) => inTerminal(cell, (process) => timeline(cell, process, args)),
  plot: (cell, args) => inTerminal(cell, (process) => drawPlot(cell, process, args)),
  robot: (cell, args) => inTerminal(cell, (process) => robot(cell, process, { seconds: secondsOf(cell), ...args })),
  graph: (cell, args) => inTerminal(cell, (process) => drawGraph(cell, process, args)),
};

async function magic(cell, word, rest) {
  if (word in MAGICS) {
    try {
      await MAGICS[word](cell, read(word, rest));
    } catch (error) {
      if (!(error instanceof UsageError)) throw error;
      cell.fail(error.message);
    }
  } else if (word === "env") setVariable(cell, rest);
  else if (word === "ros2") await inTerminal(cell, (process) => runCommands(cell, process, `ros2 ${rest}`));
  else if (word === "!") cell.fail(`!${rest}: a page has no shell. It runs in a notebook.`);
  else cell.fail(`%${word} does not work in a page. These do: %${[...Object.keys(MAGICS), "env", "ros2"].join(", %")}.`);
}

// How long a cell records (s).
const secondsOf = (cell) => cell.about.seconds ?? SHOWN_S;

// `%env NAME=VALUE`, `%env NAME VALUE`, `%env NAME`, `%env`, and a terminal's `export`: for processes started later.
function setVariable(cell, line) {
  const [, name, value] = /^(\w*)[=\s]*(.*)$/.exec(line) ?? [];
  if (!name) return Object.entries(environment).forEach(([key, value]) => cell.print(`${key}=${value}`));
  if (!value) return cell.print(environment[name] ?? "");
  environment[name] = value.replace(/^(["'])(.*)\1$/, "$2");
  cell.print(`env: ${name}=${environment[name]}`);
}

async function drawPlot(cell, process, { words: paths, seconds = secondsOf(cell), title = "" }) {
  cell.say(`Recording for ${seconds} s …`, "running");
  const drawn = await process.call("plot.plot", { paths, seconds, title });
  if (drawn) show(cell, drawn, "live-plot");
}

async function drawGraph(cell, process, { seconds = GRAPH_S }) {
  cell.say(`Counting messages for ${seconds} s …`, "running");
  const counted = await process.call("node_graph.counted", { seconds });
  if (counted?.pictures.length) cell.shown?.append(graph(counted));
  else cell.print("No node runs. Run one.");
}

export async function runTerminal(cell) {
  await inTerminal(cell, (process) => runCommands(cell, process, cell.source));
}

async function runCommands(cell, process, source) {
  const commands = (await process.call("cells.commands", { source })) ?? [];
  for (const command of commands) {
    await runCommand(cell, process, command);
    if (cell.failed) return;
  }
  if (commands.every(({ why }) => why)) cell.fail();
}

async function runCommand(cell, process, command) {
  const { kind, words, text, why } = command;
  const exported = /^# export (\w+=.*)/.exec(text);
  const missing = notWritten(text);
  const absent = words && absentLaunchFile(words);
  if (why) cell.print(`${text}\n    does not run in a page: ${why}`, "stderr");
  else if (exported) setVariable(cell, exported[1]);
  else if (kind === "rqt_plot") await drawPlot(cell, process, read("plot", text.replace(/^\S+/, "")));
  else if (kind === "rqt_graph") await drawGraph(cell, process, {});
  else if (kind === "colcon") cell.print("colcon is not needed in a page: `ros2 run` finds the page's nodes without it.");
  else if (missing) cell.fail(`Run ${missing} above first.`);
  else if (absent) cell.fail(absent);
  else if (kind === "ros2" && words[1] === "run") await runExecutable(cell, words);
  else if (kind === "ros2" && words[1] === "launch" && !SHOWS_ONLY.test(text)) await launch(cell, process, text);
  else if (kind === "ros2") await bounded(cell, process, text);
}

// Run a command. It is ended after a while, as in the notebook, or once its output contains the text that the chapter
// names. The seconds of endless output count from the first line, so that a slow computer shows as much as a fast one.
async function bounded(cell, process, line) {
  const endless = ENDLESS.test(line) && !BOUNDED.test(`${line} `);
  const seconds = cell.about.seconds ?? (endless ? SHOWN_S : LONGEST_S);
  let why = "";
  let over = false;
  const interrupt = (reason) => {
    why = reason;
    process.signal("SIGINT");
  };
  const ended = endless ? `Ended after ${seconds} s of output, as Ctrl-C does.` : `Ended, because it took longer than ${seconds} s.`;
  const atMost = cell.about.seconds ? seconds + START_S : seconds;
  let timer = setTimeout(() => interrupt(ended), 1000 * atMost);
  cell.nextLine().then(() => {
    if (over) return;
    clearTimeout(timer);
    timer = setTimeout(() => interrupt(ended), 1000 * seconds);
  });
  if (cell.until) cell.seen.then(() => over || interrupt("Ended, as all that the chapter shows is here."));
  cell.say("Running …", "running");
  try {
    const status = await result(cell, process, "cells.run_command", { line, files: files() });
    if (process.interrupted) why ||= "Ended by Ctrl-C.";
    if (!why || status === null) return;
    cell.failed = false;
    cell.say(why, "ended");
  } finally {
    over = true;
    clearTimeout(timer);
  }
}

export async function runFile(cell) {
  cell.print(`Wrote ${keep(cell.file, cell.source)}`);
}

export async function runInterface(cell) {
  await inTerminal(cell, (process) => result(cell, process, "cells.define", { path: cell.file, text: cell.source }));
}
