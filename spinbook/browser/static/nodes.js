// The nodes of a page: started by their cells or by `ros2 run`, listed and stopped as in a notebook.
import { cellOf, cells, logs } from "./cell.js";
import { after, failure } from "./elements.js";
import { files } from "./workspace.js";
import { named, take } from "./processes.js";
import { turtle } from "./turtle.js";

const TURTLESIM = "import sys\nfrom ros_in_python.turtlesim.node import main\nsys.exit(main())\n";
const DEMOS = /^demo_nodes_(cpp|py)\/(talker|listener|add_two_ints_server|add_two_ints_client)$/;
// How long `ros2 run` of a turtlesim_node shows output before the cell goes on (s).
const SHOWN_S = 3;
// The longest that `%log --until` waits (s).
const LOG_S = 30;

// Every node that was started and has not been stopped since, by name, in order.
export const started = new Map();
let starts = 0;

// Start a program as a node, and wait until it runs. `into` is the cell that shows its output.
async function start(name, into, program, file, args) {
  await (started.get(name)?.running ? started.get(name) : named(name))?.stop();
  logs.delete(name);
  started.delete(name);
  const process = take(name, into.hears(name));
  started.set(name, process);
  const turn = (into.started = ++starts);
  // The cell may show another program by then.
  const say = (text, phase) => into.started === turn && (into.now.runs(null), into.say(text, phase));
  into.now.runs(() => process.stop());
  into.ended = process.program(program, file, args, files()).then(
    (status) => {
      say(ending(name, status, process), status ? "failed" : "ended");
      if (status) into.failed = true;
    },
    (error) => into.fail(say(failure(error), "failed")),
  );
  await process.ready;
  if (process.running) into.say(`${name} runs.`, "running");
}

function ending(name, status, process) {
  process.status = status;
  if (status !== null) return `${name} ended with ${status}.`;
  if (!process.forced) return `${name} was ended.`;
  return `${name} did not react to Ctrl-C, so it was ended after 2 s. A loop that never waits can't react: use a timer.`;
}

// Run a node's cell. Resolves when it has started, or has ended at once.
export async function runNode(cell, into = cell, args = []) {
  const earlier = started.get(cell.about.replaces);
  if (earlier) {
    into.print(`(replaces ${earlier.name}, the earlier version of this node)`);
    await earlier.stop();
    started.delete(earlier.name);
  }
  await start(cell.name, into, cell.program, cell.file, args);
  await Promise.race([into.ended, after(500)]);
}

// `ros2 run PACKAGE EXECUTABLE …`: a node of this page, turtlesim, or a demo node.
export async function runExecutable(cell, [, , pack, executable, ...args]) {
  const name = args.map((word) => /^__(?:node|name):=(.*)/.exec(word)?.[1]).find(Boolean);
  const program = programOf(cell, pack, executable);
  if ((!program || program.cell) && !isPackage(pack)) return cell.fail(`Package '${pack}' not found.`);
  if (!program) return cell.fail(`There is no node ${executable} on this page.`);
  // Under its own name, it replaces the earlier version of its cell's node.
  if (program.cell && !name) await runNode(program.cell, cell, args);
  else await start(name ?? executable, cell, program.source, program.file, args);
  await Promise.race([cell.shows(SHOWN_S), cell.ended]);
  if (executable === "turtlesim_node" && named(name ?? executable)) cell.say("turtlesim_node runs. Show its window with %turtle.", "running");
}

// Return whether the course or a command of this page, as it is written, has this package.
function isPackage(name) {
  const names = ({ written, about }) => written.split(/\s+/).includes(name) || about.executables?.some((full) => full.startsWith(`${name}/`));
  return name === document.documentElement.dataset.package || [...cells.values()].some(names);
}

// A node that was killed, stopped while it started or could not be loaded has none.
const exitCode = ({ status }) => (Number.isInteger(status) ? ` (exit code ${status})` : "");

export function showNodes(cell) {
  if (started.size === 0) cell.print("No node runs. Run one.");
  for (const [name, process] of started) {
    const state = process.running ? "running" : `ended${exitCode(process)}`;
    cell.print(`${name.padEnd(28)} ${state.padEnd(22)} ${logs.get(name)?.length ?? 0} lines logged`);
  }
}

// Return the program that `ros2 run` or a launch file names: its text, its file, and its cell if it has one.
export function programOf(from, pack, executable) {
  if (executable === "turtlesim_node") return { source: TURTLESIM, file: "turtlesim_node.py" };
  const demo = demoNode(from, pack, executable);
  if (demo) return demo;
  const cell = cellOf(from, executable, `${pack}/${executable}`);
  return cell && { source: cell.program, file: cell.file, cell };
}

// Return the program of a node of demo_nodes_cpp or demo_nodes_py, which are part of Spinbook.
function demoNode(from, pack, executable) {
  const [, language, name] = DEMOS.exec(`${pack}/${executable}`) ?? [];
  // A chapter may have a program of its own with that name.
  if (!name || cellOf(from, "", `${pack}/${executable}`)) return undefined;
  const source = `import sys\nfrom ros_in_python.demo_nodes import main\nsys.exit(main(["${language}", "${name}"]))\n`;
  return { source, file: `${name}.py` };
}

// `%log NAME [--until TEXT] [--seconds N]`
export async function showLog(cell, { words: [name], until, seconds = LOG_S }) {
  if (!started.has(name) && !logs.has(name)) return refuse(cell, name);
  if (until && !(await logHolds(name, until, seconds))) cell.print(`The text ${until} did not appear.`);
  for (const line of logs.get(name) ?? []) cell.print(line);
}

// Resolves when a log contains a text (true), or when the time is up or the node has ended.
async function logHolds(name, text, seconds) {
  const end = Date.now() + 1000 * seconds;
  const holds = () => (logs.get(name) ?? []).some((line) => line.includes(text));
  while (!holds() && Date.now() < end && started.get(name)?.running) {
    await after(50);
  }
  return holds();
}

function refuse(cell, name) {
  cell.fail(`This page has not started a node \`${name}\`. Started: ${[...started.keys()].join(", ") || "none"}.`);
}

export async function stop(cell, { words, all }) {
  const names = all ? [...started.keys()] : words;
  const unknown = names.find((name) => !started.has(name));
  if (unknown) return refuse(cell, unknown);
  if (!all && words.length === 0) return cell.fail("Which one? %stop NAME, or %stop --all.");
  const wanted = names.map((name) => started.get(name));
  const hadEnded = wanted.map((process) => !process.running);
  await Promise.all(wanted.map((process) => process.running && process.stop()));
  for (const [at, process] of wanted.entries()) {
    cell.print(stopped(process, hadEnded[at]));
    started.delete(process.name);
  }
}

function stopped({ name, status, forced }, hadEnded) {
  if (hadEnded) return `${name} had ended before${exitCode({ status })}.`;
  if (forced) return `${name} ignored Ctrl-C for 2 s; it was ended.`;
  return status ? `${name} stopped with exit code ${status}; a node that ends normally has 0.` : `${name} stopped.`;
}

export function showTurtle(cell) {
  const node = named("turtlesim_node");
  if (node) cell.shown?.append(turtle(node));
  else cell.fail("turtlesim does not run: ros2 run turtlesim turtlesim_node");
}
