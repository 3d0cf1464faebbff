// A process of the page: one web worker, in which Pyodide runs one program, or the page's cells one after another.
import { VERSION, addressOf } from "./address.js";
import { loadPyodide } from "./pyodide.mjs";

const inbox = [];
const keys = [];
const signals = [];
const waiting = new Set();

// The functions that in_page/link.py calls: to send and receive frames, and to wait, which is a promise.
const page = {
  send: (head, data) => self.postMessage({ op: "frame", head, data }),
  receive: () => inbox.shift(),
  key: () => keys.shift(),
  picture: (text) => self.postMessage({ op: "picture", text }),
  signal: () => signals.shift(),
  wait: (ms, forFrames) =>
    new Promise((resolve) => {
      // Even a wait of 0 lets the event loop run.
      if (ms === 0 || (forFrames && inbox.length > 0)) return void setTimeout(resolve, 0);
      waiting.add(resolve);
      if (ms > 0) setTimeout(() => waiting.delete(resolve) && resolve(), ms);
    }),
  wake: arrived,
  // Start a thread: the function runs on a stack of its own.
  spawn: (run) => void setTimeout(() => run.callPromising().finally(() => run.destroy())),
};

// Let all waiting threads check again.
function arrived() {
  const all = [...waiting];
  waiting.clear();
  all.forEach((resolve) => resolve());
}

const print = (stream) => (text) => self.postMessage({ op: "output", stream, text });

const progress = (part) => self.postMessage({ op: "progress", part });

async function bytes(name) {
  const response = await fetch(addressOf(name));
  if (!response.ok) throw new Error(`${name}: ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

// If there is no memory for another program, Pyodide only warns and never returns; this promise rejects then.
const lacking = new Promise((resolve, reject) => {
  const { instantiate } = WebAssembly;
  WebAssembly.instantiate = async (...args) => {
    try {
      return await instantiate.apply(WebAssembly, args);
    } catch (error) {
      if (error instanceof RangeError) reject(error);
      throw error;
    }
  };
});

// Pyodide's code, which the page compiles once for all processes. Pyodide gets it instead of loading and compiling it,
// and its modules are in an archive of the page.
let code = null;
const { fetch: load } = self;
self.fetch = (address, ...options) => {
  if (String(address).endsWith("/python_stdlib.zip")) return Promise.resolve(new Response());
  return String(address).endsWith(".asm.wasm") ? code : load(address, ...options);
};
WebAssembly.instantiateStreaming = async (source, imports) => {
  const module = await source;
  return { module, instance: await WebAssembly.instantiate(module, imports) };
};

const PAGE = 4096 / Uint32Array.BYTES_PER_ELEMENT;

// The `set` with which Pyodide writes a snapshot, without its empty pages: what is never written takes no memory.
function setFullPages(bytes, at = 0) {
  const { set } = Uint8Array.prototype;
  if (bytes.length < 4 * PAGE) return void set.call(this, bytes, at);
  const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
  const old = new Uint32Array(this.buffer, this.byteOffset + at, words.length);
  for (let from = 0; from < words.length; from += PAGE) {
    if (!isEmpty(words, from) || !isEmpty(old, from)) old.set(words.subarray(from, from + PAGE), from);
  }
}

function isEmpty(words, from) {
  for (let at = from; at < from + PAGE; at++) if (words[at]) return false;
  return true;
}

const PREPARE = 'import sys; sys.path.insert(0, "/ros.zip"); from spinbook.browser.in_page import process; process.prepare()';

// Start Python with ROS 2 from the memory of an earlier process, a Blob; without one, anew, and hand over its memory.
async function python(memory, archives) {
  const read = async ({ name, data }) => [name, new Uint8Array(await data.arrayBuffer())];
  const copies = memory ? [] : await Promise.all(archives.map(read));
  const options = {
    indexURL: new URL("./", import.meta.url).href,
    stdout: print("stdout"),
    stderr: print("stderr"),
    fsInit: (FS) => {
      FS.mkdir("/archives");
      // Each look into a Blob waits for the browser, so a process that imports everything has copies: it starts 1 s sooner.
      if (memory) FS.mount(FS.filesystems.WORKERFS, { blobs: archives }, "/archives");
      for (const [name, copy] of copies) FS.writeFile(`/archives/${name}`, copy, { canOwn: true });
      FS.symlink("/archives/ros.zip", "/ros.zip");
      const { writeFile } = FS;
      FS.writeFile = (path, data, options) => {
        if (/^\/lib\/python\d+\.zip$/.test(path)) return FS.symlink("/archives/python_stdlib.zip", path);
        return writeFile(path, data, { canOwn: true, ...options }); // no second copy
      };
    },
  };
  if (memory) {
    const copy = new Uint8Array(memory.size);
    let filled = 0; // Read as a stream: arrayBuffer() would cost each process 28 MB more.
    for await (const part of memory.stream()) {
      copy.set(part, filled);
      filled += part.length;
      part.buffer.transfer(0); // Garbage would stay for minutes.
    }
    Int8Array.prototype.set = setFullPages;
    const loading = loadPyodide({ ...options, _loadSnapshot: copy });
    const py = await loading.finally(() => delete Int8Array.prototype.set);
    copy.buffer.transfer(0); // Pyodide keeps references to it: 31 MB in each process. This frees them.
    return py;
  }
  progress("Python");
  const py = await loadPyodide({ ...options, _makeSnapshot: true });
  progress("ROS 2");
  py.runPython(PREPARE);
  const snapshot = py.makeMemorySnapshot();
  self.postMessage({ op: "memory", memory: new Blob([snapshot]) });
  snapshot.buffer.transfer(0);
  return py;
}

async function start({ identity, archives, memory }) {
  const anew = () => python(null, archives);
  const py = await Promise.race([lacking, memory ? python(memory, archives).catch(anew) : anew()]);
  const process = py.pyimport("spinbook.browser.in_page.process");
  process.open_process(page, identity);
  return { py, process };
}

let ready = null;

// What functions of in_page need besides ros.zip: interfaces with their files, or the checks and these.
const NEEDS_SHARES = /^((advice|check|launch_plan|plot|robot|trial)\.|cells\.(define|run_command)$|timeline\.record$)/;
const NEEDS_CHECKS = /^(check|trial)\./;

// Do what the page asks for: start, or call a function of in_page by its module and name, and its arguments by theirs.
async function answer({ op, id, files, ...given }) {
  if (op === "start") {
    if (given.version !== VERSION) throw new Error("another version");
    code = given.compiled;
    ready = start(given);
    return void (await ready);
  }
  const { py, process } = await ready;
  if (NEEDS_SHARES.test(op)) await (py.shared ??= unpackShares(py));
  if (NEEDS_CHECKS.test(op)) await (py.checks ??= unpackChecks(py, process));
  await put(py, files);
  return JSON.parse(await process.answer.callPromising(page, op, py.toPy(given)));
}

async function unpackChecks(py, process) {
  progress("checks");
  py.FS.writeFile("/check.zip", await bytes("check.zip"));
  py.runPython('import sys; sys.path.insert(0, "/check.zip")');
  process.find_grader_in("/check.zip");
}

// Write the files of the chapter's package where programs look for them, and those of a launch.
async function put(py, { pack, texts, more } = { texts: {} }) {
  if (Object.keys(texts).length) py.pyimport("spinbook.browser.in_page.workspace").put(py.toPy(texts), pack);
  for (const [path, text] of Object.entries(more ?? {})) {
    py.FS.mkdirTree(path.slice(0, path.lastIndexOf("/")));
    py.FS.writeFile(path, text);
  }
}

// Unpack the available interfaces and their files, when the first command or check runs.
async function unpackShares(py) {
  py.unpackArchive(await bytes("share.zip"), "zip", { extractDir: "/opt/ros" });
  py.runPython('import os; os.environ["AMENT_PREFIX_PATH"] = "/opt/ros"');
}

self.onmessage = async ({ data: message }) => {
  if (message.op === "frame") {
    inbox.push({ head: message.head, data: message.data });
    arrived();
    return;
  }
  if (message.op === "signal") {
    signals.push(message.name);
    arrived();
    return;
  }
  if (message.op === "ask") return void self.postMessage({ op: "here" });
  if (message.op === "key") return void keys.push(message);
  try {
    self.postMessage({ op: "done", id: message.id, value: await answer(message) });
  } catch (error) {
    // `os._exit` ends Python itself, with a program's status.
    const ended = message.op === "process.run_program" && Number.isInteger(error?.status) ? { value: error.status } : { error: String(error) };
    self.postMessage({ op: "done", id: message.id, ...ended });
  }
};
