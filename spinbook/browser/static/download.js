// The download that all nodes of a course share: shows its progress, and caches the files for use without a network.
import { VERSION, addressOf } from "./address.js";
import { after, hindrance } from "./elements.js";
import { prepared } from "./processes.js";

const base = new URL("./", import.meta.url);
const COURSE = new URL("../", base).href;
const READY_MS = 4000;
// What the first node needs. The rest loads while it starts.
const FIRST = /^(pyodide|python|ros|worker)/;
let loading = null;
let say = () => {};

// Load the files for nodes, once; `hear` gets the progress in words, and from 0 to 1. Resolves when a node can start.
// Without a service worker, each file loads when it is needed.
export async function download(hear) {
  say = hear;
  const rest = await first();
  say = () => {}; // What the reader waits for is there.
  if (!rest) return;
  loading = Promise.resolve(null);
  rest().catch(() => {}); // Without a network, what was kept before stays.
}

// Start a process that waits for its program, before there is one. Resolves with it; with null where there can be none.
export async function prepare() {
  if (hindrance()) return null;
  await first();
  return prepared();
}

// Load what the first node needs. Resolves with what loads the rest, or with null.
const first = () => (loading ??= load().catch(() => (loading = null)));

async function load() {
  if (!(await serviceWorker())) return null;
  const { files } = await (await fetch(addressOf("files.json"))).json();
  const earlier = (await caches.keys()).filter((name) => name.startsWith("run-") && name !== `run-${VERSION}`);
  const cache = await caches.open(`run-${VERSION}`);
  const missing = [];
  for (const [name, [size, digest]] of Object.entries(files)) {
    if (!(await cache.match(addressOf(name))) && !(await taken(earlier, cache, name, digest))) missing.push([name, size, digest]);
  }
  const whole = missing.reduce((sum, [, size]) => sum + size, 0);
  let loaded = 0;
  const report = (size) => say(`Loading ${megabytes((loaded += size))} of ${megabytes(whole)} MB, once for this course …`, loaded / whole);
  const fetchAll = (files) => Promise.all(files.map(([name, , digest]) => fetchInto(cache, addressOf(name), digest, report)));
  await fetchAll(missing.filter(([name]) => FIRST.test(name)));
  return async () => {
    await fetchAll(missing.filter(([name]) => !FIRST.test(name)));
    await Promise.all(earlier.map((name) => caches.delete(name)));
    await keepCourse();
  };
}

// Take a file that has not changed from the cache of an earlier version.
async function taken(earlier, cache, name, digest) {
  for (const each of earlier) {
    const response = await (await caches.open(each)).match(new URL(name, base), { ignoreSearch: true });
    if (response?.headers.get("digest") === digest) return cache.put(addressOf(name), response).then(() => true);
  }
  return false;
}

// Keep every page of the course, with its pictures and downloads, for reading without a network. Unchanged ones are not
// loaded again.
async function keepCourse() {
  const files = await (await fetch(`${COURSE}offline.json`, { cache: "no-store" })).json();
  const pages = await caches.open("pages");
  const known = (await (await pages.match(`${COURSE}offline.json`))?.json()) ?? {};
  const changed = Object.keys(files).filter((path) => files[path] !== known[path]);
  const kept = await Promise.allSettled(changed.map((path) => pages.add(new Request(COURSE + path, { cache: "reload" }))));
  const there = { ...files };
  changed.forEach((path, at) => kept[at].status === "fulfilled" || delete there[path]);
  await pages.put(`${COURSE}offline.json`, new Response(JSON.stringify(there)));
}

const megabytes = (size) => (size / 1e6).toFixed(1);

async function fetchInto(cache, address, digest, report) {
  const response = await fetch(address, { cache: "reload" });
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  const [counted, stored] = response.body.tee();
  const headers = new Headers(response.headers);
  headers.set("digest", digest);
  const storing = cache.put(address, new Response(stored, { headers }));
  const reader = counted.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) report(part.value.length);
  await storing;
}

// Return whether a service worker controls this page, once it does. A page that has one does not wait for its renewal,
// which took Chromium a minute on a second visit.
async function serviceWorker() {
  if (!("serviceWorker" in navigator) || !window.isSecureContext) return false;
  const known = navigator.serviceWorker.register(new URL("../offline.js", base), { scope: new URL("../", base).href });
  if (navigator.serviceWorker.controller) {
    known.catch(() => {});
    return true;
  }
  await known;
  const controlled = new Promise((resolve) => navigator.serviceWorker.addEventListener("controllerchange", () => resolve(true)));
  return Promise.race([controlled, after(READY_MS, false)]);
}
