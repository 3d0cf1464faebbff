// The download that all nodes of a course share: shows its progress, and caches the files for use without a network.

const base = new URL("./", import.meta.url);
const READY_MS = 4000;
let done = null;

// Load the files for nodes, once; `say` gets the progress. Without a service worker, each file loads when it is needed.
export function download(say) {
  done ??= load(say).catch(() => null);
  return done;
}

async function load(say) {
  if (!(await serviceWorker())) return;
  const { version, files } = await (await fetch(new URL("files.json", base))).json();
  for (const name of await caches.keys()) if (name.startsWith("run-") && name !== `run-${version}`) await caches.delete(name);
  const cache = await caches.open(`run-${version}`);
  const missing = [];
  for (const [name, size] of Object.entries(files)) {
    if (!(await cache.match(new URL(name, base).href))) missing.push([name, size]);
  }
  const whole = missing.reduce((sum, [, size]) => sum + size, 0);
  let loaded = 0;
  const report = (size) => say(`Loading ${megabytes((loaded += size))} of ${megabytes(whole)} MB, once for this course …`);
  await Promise.all(missing.map(([name]) => fetchInto(cache, new URL(name, base), report)));
  if (missing.length) keepPages();
}

// Cache this page with everything it shows, and the other pages of the course.
async function keepPages() {
  const shown = performance.getEntriesByType("resource").map((entry) => entry.name);
  const others = [...document.querySelectorAll(".course-nav a")].map((link) => link.href);
  const wanted = new Set([location.href, ...shown, ...others].map((address) => address.split("#")[0]));
  const pages = await caches.open("pages");
  const ours = [...wanted].filter((address) => address.startsWith(new URL("../", base).href) && !address.startsWith(base.href));
  await Promise.allSettled(ours.map((address) => pages.add(address)));
}

const megabytes = (size) => (size / 1e6).toFixed(1);

async function fetchInto(cache, address, report) {
  const response = await fetch(address, { cache: "reload" });
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  const [counted, stored] = response.body.tee();
  const storing = cache.put(address.href, new Response(stored, { headers: response.headers }));
  const reader = counted.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) report(part.value.length);
  await storing;
}

// Return the service worker, once it controls this page; null if it can't.
async function serviceWorker() {
  if (!("serviceWorker" in navigator) || !window.isSecureContext) return null;
  const known = await navigator.serviceWorker.register(new URL("../offline.js", base), { scope: new URL("../", base).href });
  if (navigator.serviceWorker.controller) return known;
  const controlled = new Promise((resolve) => navigator.serviceWorker.addEventListener("controllerchange", () => resolve(known)));
  return Promise.race([controlled, new Promise((resolve) => setTimeout(resolve, READY_MS, null))]);
}
