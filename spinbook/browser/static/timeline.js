// `%timeline`: records services, actions and topics while other cells run, and draws what happened.
import { after } from "./elements.js";
import { show } from "./picture.js";
import { take } from "./processes.js";

// How long to wait for names to appear, and for messages that are still in transit at the end (ms).
const APPEAR_MS = 20_000;
const LATE_MS = 300;

let recording = null;

async function begin(cell, names) {
  recording?.process.end();
  const lines = [];
  const found = new Set();
  let all = null;
  const appeared = new Promise((resolve) => (all = resolve));
  const hear = (line) => {
    lines.push(line);
    const [kind, name] = line.startsWith("[") ? JSON.parse(line) : [];
    if (kind === "found") found.add(name);
    if (kind === "error" || names.every((each) => found.has(each))) all();
  };
  const process = take("timeline", { output: (text, stream) => stream === "stdout" && hear(text) });
  process.overhears = true;
  recording = { process, names, lines };
  await process.ready;
  process.call("timeline.record", { names });
  await Promise.race([appeared, after(APPEAR_MS)]);
  cell.print(`Recording ${names.join(", ")}. %timeline draws what happens from now on.`);
  const missing = names.filter((name) => !found.has(name));
  if (missing.length) cell.print(`Not found yet: ${missing.join(", ")}.`);
}

async function finish(cell, process, title) {
  if (!recording) return cell.fail("Nothing is being recorded. Begin with: %timeline --record /NAME");
  const { names, lines, process: recorder } = recording;
  recording = null;
  await after(LATE_MS);
  recorder.end();
  show(cell, await process.call("timeline.drawn", { names, lines, title }), "live-timeline");
}

export async function timeline(cell, process, { record, title = "" }) {
  if (record) await begin(cell, record);
  else await finish(cell, process, title);
}
