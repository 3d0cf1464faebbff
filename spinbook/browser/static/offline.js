// The service worker of a course: once it has run a node, its pages and nodes work without a network.

const PAGES = "pages";
// Files that change only with their version are taken from the cache first; see download.js.
const LARGE = /\/run\/(pyodide[^/]*|[^/]+\.(zip|wasm))$/;

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const { origin, pathname } = new URL(request.url);
  if (request.method !== "GET" || origin !== self.location.origin) return;
  const large = LARGE.test(pathname) && request.cache !== "reload";
  event.respondWith(large ? cacheFirst(request) : networkFirst(request));
});

async function cacheFirst(request) {
  return (await caches.match(request)) ?? fetch(request);
}

async function networkFirst(request) {
  try {
    const response = await fetch(request);
    if (response.ok && request.cache !== "reload") (await caches.open(PAGES)).put(request, response.clone());
    return response;
  } catch {
    return (await caches.match(request, { ignoreSearch: true })) ?? Response.error();
  }
}
