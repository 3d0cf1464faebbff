// The processes of a page and the hub between them: each is a web worker, and what one sends the others get.

const STOP_MS = 2000;
// Log lines look as in the notebook.
const ENVIRONMENT = { RCUTILS_CONSOLE_OUTPUT_FORMAT: "[{severity}] [{name}]: {message}" };
const base = new URL("./", import.meta.url);
const all = new Map();
let count = 0;

export const running = () => [...all.values()].filter((process) => process.running);
export const named = (name) => running().find((process) => process.name === name);

const processOf = (key) => key.slice(0, key.lastIndexOf("."));

// Frames to named endpoints go to the processes that have them; all others go to everybody.
function route(from, head, data) {
  const frame = JSON.parse(head);
  const wanted = frame.to ? new Set(frame.to.map(processOf)) : null;
  for (const process of all.values()) {
    if (process !== from && process.joined && (!wanted || wanted.has(process.identity))) {
      process.worker.postMessage({ op: "frame", head, data });
    }
  }
}

export class Process {
  constructor(name, hears) {
    this.name = name;
    this.hears = hears;
    this.identity = `w${++count}`;
    this.joined = true;
    this.running = false;
    this.calls = new Map();
    this.worker = new Worker(new URL("worker.js", base), { type: "module", name });
    this.worker.onmessage = ({ data }) => this.#heard(data);
    this.worker.onerror = (event) => this.#broke(event.message || "The browser could not start it.");
    all.set(this.identity, this);
    this.ready = this.call("start", { identity: this.identity });
    this.ready.catch(() => this.end());
  }

  // Have the worker do something; a promise of what comes of it.
  call(op, given = {}) {
    const id = ++count;
    this.worker.postMessage({ op, id, ...given });
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  #heard(message) {
    if (message.op === "frame") route(this, message.head, message.data);
    else if (message.op === "output") this.hears.output?.(message.text, message.stream);
    else if (message.op === "picture") this.hears.picture?.(message.text);
    else if (message.op === "progress") this.hears.progress?.(message.part);
    else if (message.op === "done") {
      const { resolve, reject } = this.calls.get(message.id);
      this.calls.delete(message.id);
      if (message.error) reject(new Error(message.error));
      else resolve(message.value);
    }
  }

  #broke(text) {
    for (const { reject } of this.calls.values()) reject(new Error(text));
    this.calls.clear();
    this.end();
  }

  signal(name) {
    this.worker.postMessage({ op: "frame", head: JSON.stringify({ op: "signal", name }) });
  }

  // As Ctrl-C; what does not end then is ended.
  async stop() {
    if (!all.has(this.identity)) return;
    this.signal("SIGINT");
    await Promise.race([this.ended, new Promise((resolve) => setTimeout(resolve, STOP_MS))]);
    this.end();
  }

  // Run a program to its end; its exit status, or null if it had to be ended.
  async program(source, file, args = []) {
    this.running = true;
    this.ended = this.ready
      .then(() => this.call("program", { source, file, args, environment: ENVIRONMENT }))
      .finally(() => this.end());
    return this.ended;
  }

  end() {
    if (!all.delete(this.identity)) return;
    this.running = false;
    this.worker.terminate();
    for (const { resolve } of this.calls.values()) resolve(null);
    this.calls.clear();
    route(this, JSON.stringify({ op: "bye", from: this.identity }));
    this.hears.end?.();
  }
}
