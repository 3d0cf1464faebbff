// The processes of a page, each a web worker, and the hub between them, which forwards each one's frames to the others.
import { VERSION, addressOf } from "./address.js";
import { after } from "./elements.js";

const STOP_MS = 2000;
// How often to check that a program still responds, and how long it may take before it counts as blocked.
const ASK_MS = 2000;
const SILENT_MS = 10_000;
const MEMORY = addressOf("memory");
// The os.environ of programs. Log lines have the same form as in the notebook.
export const environment = { RCUTILS_CONSOLE_OUTPUT_FORMAT: "[{severity}] [{name}]: {message}" };
// Announces that a process has started or ended.
export const changes = new EventTarget();
const all = new Map();
let count = 0;
// The memory of the first process when Python had started, a Blob. All others start with a copy of it, also after a
// reload: this takes a tenth of the computing. Without a secure connection, or where storage is forbidden, none is kept.
let memory = keptMemory().catch(() => null);
// What all processes share: Python's code, compiled, and the archives with its modules and with ROS 2, which the browser
// keeps once, as Blobs.
let shared = null;
// A process that has started, and waits for its program.
let spare = null;

// Return the process that waits for its program; start it if there is none.
export function prepared() {
  if (!spare?.alive) spare = new Process();
  return spare;
}

// Return a process for a program: the one that waits, if there is one.
export function take(name, hears) {
  const process = prepared();
  spare = null;
  process.join(name, hears);
  return process;
}

const load = () => Promise.all([WebAssembly.compileStreaming(fetch(addressOf("pyodide.asm.wasm"))), ...["python_stdlib.zip", "ros.zip"].map(archive)]);

async function archive(name) {
  const response = await fetch(addressOf(name));
  if (!response.ok) throw new Error(`${name}: ${response.status}`);
  return { name, data: await response.blob() };
}

async function keptMemory() {
  return (await caches.match(MEMORY))?.blob();
}

async function keepMemory(blob) {
  memory = Promise.resolve(blob);
  try {
    await (await caches.open(`run-${VERSION}`)).put(MEMORY, new Response(blob));
  } catch {
    // The processes of this page start with it all the same.
  }
}

export const running = () => [...all.values()].filter((process) => process.running);
export const working = () => [...all.values()].filter((process) => process.task);
export const named = (name) => running().find((process) => process.name === name);

const changed = () => changes.dispatchEvent(new Event("change"));
const processOf = (key) => key.slice(0, key.lastIndexOf("."));

// Frames to named endpoints go to the processes that have them; all others go to all processes.
function route(from, head, data) {
  const frame = JSON.parse(head);
  const receivers = frame.to ? new Set(frame.to.map(processOf)) : null;
  for (const process of all.values()) {
    // A process that overhears gets all responses.
    const overhears = process.overhears && frame.op === "response";
    if (process !== from && (!receivers || receivers.has(process.identity) || overhears)) {
      process.worker.postMessage({ op: "frame", head, data });
    }
  }
}

export class Process {
  constructor() {
    this.hears = {};
    this.identity = `w${++count}`;
    this.running = false;
    this.alive = true;
    this.calls = new Map();
    this.worker = new Worker(addressOf("worker.js"), { type: "module", name: this.identity });
    this.worker.onmessage = ({ data }) => this.#heard(data);
    this.worker.onerror = (event) => this.#broke(event.message || "The browser could not start it.");
    shared ??= load();
    shared.catch(() => (shared = null));
    const started = Promise.all([shared, memory]).then(([[compiled, ...archives], memory]) =>
      this.call("start", { version: VERSION, identity: this.identity, compiled, archives, memory }),
    );
    // Once it was ended, nobody waits for what it would start with.
    this.ready = Promise.race([started, new Promise((resolve) => (this.finish = resolve))]);
    this.ready.then(() => (this.isReady = true), () => this.end());
  }

  // Join the graph: from now on, it gets the others' frames.
  join(name, hears) {
    this.name = name;
    this.hears = hears;
    if (this.alive) all.set(this.identity, this);
    if (this.part) hears.progress?.(this.part);
  }

  // Let the worker do something. Resolves with the result, or with null if the process ends first.
  call(op, given = {}) {
    if (!this.alive) return this.fault ? Promise.reject(this.fault) : Promise.resolve(null);
    const id = ++count;
    this.worker.postMessage({ op, id, ...given });
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  #heard(message) {
    if (message.op === "frame") route(this, message.head, message.data);
    else if (message.op === "output") this.hears.output?.(message.text, message.stream);
    else if (message.op === "picture") this.hears.picture?.(message.text);
    else if (message.op === "progress") this.hears.progress?.((this.part = message.part));
    else if (message.op === "memory") keepMemory(message.memory);
    else if (message.op === "here") this.#listens();
    else if (message.op === "done") {
      const { resolve, reject } = this.calls.get(message.id);
      this.calls.delete(message.id);
      if (message.error) reject(new Error(message.error));
      else resolve(message.value);
    }
  }

  #broke(text) {
    this.fault = new Error(text);
    for (const { reject } of this.calls.values()) reject(this.fault);
    this.calls.clear();
    this.end();
  }

  signal(name) {
    this.worker.postMessage({ op: "signal", name });
  }

  // Interrupt it as Ctrl-C does, and kill it if it does not end, or has not begun.
  async stop() {
    if (!this.isReady) return this.end();
    // A terminal whose launch runs elsewhere does nothing: the signal would end its next command.
    if (this.calls.size === 0) return;
    this.interrupted = true;
    this.signal("SIGINT");
    const ended = this.ended ?? this.idle;
    if ((await Promise.race([ended, after(STOP_MS, "late")])) !== "late") return;
    this.forced = true;
    this.end();
    await ended;
  }

  // Run a program to its end. Resolves with its exit status, or with null if it was killed.
  async program(source, file, args = [], files = undefined) {
    this.running = true;
    changed();
    this.ended = this.ready
      .then(() => this.#watch())
      .then(() => this.call("process.run_program", { source, file, args, environment, files }))
      .finally(() => this.end());
    return this.ended;
  }

  // Note which cell it works for from now on; "" for none.
  work(task) {
    this.task = task;
    this.interrupted = false;
    if (task) this.idle = new Promise((resolve) => (this.rest = resolve));
    else this.rest();
    changed();
  }

  // Check repeatedly whether it responds: a program that computes without a pause does not.
  #watch() {
    if (!this.alive) return;
    this.watching = setInterval(() => {
      if (!this.asked) {
        this.asked = Date.now();
        this.worker.postMessage({ op: "ask" });
      } else if (!this.silent && Date.now() - this.asked > SILENT_MS) {
        this.silent = true;
        this.hears.silent?.(true);
      }
    }, ASK_MS);
  }

  #listens() {
    this.asked = 0;
    if (this.silent) this.hears.silent?.(false);
    this.silent = false;
  }

  end() {
    if (!this.alive) return;
    this.alive = this.running = false;
    this.finish();
    all.delete(this.identity);
    clearInterval(this.watching);
    this.worker.terminate();
    for (const { resolve } of this.calls.values()) resolve(null);
    this.calls.clear();
    route(this, JSON.stringify({ op: "bye", from: this.identity }));
    this.hears.end?.();
    changed();
  }
}
