// `ros2 launch`: several nodes under one name. Each line of output begins with its node; one Stop ends them all.
import { logs } from "./cell.js";
import { programOf, started } from "./nodes.js";
import { take } from "./processes.js";
import { files } from "./workspace.js";

const SHOWN_S = 3;

let count = 0;

class Launch {
  constructor(name, cell) {
    this.name = name;
    this.identity = `launch ${++count}`;
    this.cell = cell;
    this.hears = cell.hears(name);
    this.parts = [];
    this.died = false;
    this.timers = new Set();
    this.over = new Promise((resolve) => (this.finish = resolve));
  }

  // As in a terminal: processes that died don't count once the launch was interrupted.
  get status() {
    return this.died && !this.stopped ? 1 : 0;
  }

  get running() {
    return this.timers.size > 0 || this.parts.some((part) => part.running);
  }

  print(text) {
    this.hears.output(text, "stdout");
  }

  begin(steps) {
    for (const step of steps) {
      if ("say" in step) this.print(`[INFO] [launch.user]: ${step.say}`);
      else if ("after" in step) this.#later(step);
      else if ("shutdown" in step) this.#interrupt();
      else if (!this.interrupted) this.#start(step);
    }
    if (!this.running) this.finish();
  }

  #later({ after, steps }) {
    if (this.interrupted) return;
    const timer = setTimeout(() => {
      this.timers.delete(timer);
      this.begin(steps);
      this.announce();
    }, after * 1000);
    this.timers.add(timer);
  }

  #start({ package: pack, executable, args, files: more, onStart, onExit }) {
    const number = this.parts.length + 1;
    const name = `${executable}-${number}`;
    const { source, file } = programOf(this.cell, pack, executable);
    const part = take(name, { ...this.hears, output: (text) => this.print(`[${name}] ${text}`) });
    part.launch = this;
    this.parts.push(part);
    this.print(`[INFO] [${name}]: process started with pid [${number}]`);
    part.program(source, file, args, files(more)).then(
      (status) => this.#ended(name, number, status, onExit),
      (error) => this.#ended(name, number, error.message, onExit),
    );
    this.begin(onStart);
  }

  #ended(name, number, status, onExit) {
    if (status === 0) this.print(`[INFO] [${name}]: process has finished cleanly [pid ${number}]`);
    else {
      this.print(`[ERROR] [${name}]: process has died [pid ${number}, exit code ${status ?? -9}]`);
      this.died ||= !this.interrupted;
    }
    this.begin(onExit);
    if (onExit.length > 0) this.announce();
  }

  #interrupt() {
    this.interrupted = true;
    this.timers.forEach(clearTimeout);
    this.timers.clear();
    return Promise.all(this.parts.map((part) => part.running && part.stop()));
  }

  // Say that it runs, when all of its nodes are ready: until then, each says what it is doing.
  async announce() {
    await Promise.race([Promise.allSettled(this.parts.map(({ ready }) => ready)), this.over]);
    if (this.running) this.cell.say(`${this.name} runs.`, "running");
  }

  // Interrupt all of them, as Ctrl-C does.
  async stop() {
    if (!this.running) return;
    this.stopped = true;
    this.print("[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)");
    await this.#interrupt();
    if (!this.running) this.finish();
    await this.over;
  }
}

// The programs of steps, and of those that come later.
const programs = (steps) =>
  steps.flatMap((step) => [
    ...(step.executable ? [step] : []),
    ...programs([...(step.steps ?? []), ...(step.onStart ?? []), ...(step.onExit ?? [])]),
  ]);

const FILE = /([^/\s]+?)[._]launch\.(py|ya?ml|xml)\b/;

// Run `ros2 launch …`. Resolves when its output has been shown for as long as the chapter shows it. One of the same name
// that runs is ended only when the new one can start.
export async function launch(cell, process, line) {
  const name = FILE.exec(line)?.[1].split(".")[0] ?? "launch";
  const { status, steps } = (await process.call("launch_plan.plan", { line, files: files() })) ?? { status: 1 };
  if (status) return void cell.fail();
  const unknown = programs(steps).find((step) => !programOf(cell, step.package, step.executable));
  if (unknown) return cell.fail(`There is no node ${unknown.executable} on this page.`);
  await started.get(name)?.stop();
  logs.delete(name);
  const launched = new Launch(name, cell);
  started.set(name, launched);
  cell.now.runs(() => launched.stop());
  launched.begin(steps);
  // The time for their output counts from when all have started.
  await launched.announce();
  launched.over.then(() => {
    cell.now.runs(null);
    cell.say(`${name} ended with ${launched.status}.`, launched.status ? "failed" : "ended");
  });
  await Promise.race([cell.shows(SHOWN_S), launched.over]);
}
