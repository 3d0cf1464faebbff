// The service worker of a course: once it has run a node, its pages and nodes work without a network.

const PAGES = "pages";
// Files that change only with their version are taken from the cache first; see download.js.
const LARGE = /\/run\/(pyodide[^/]*|[^/]+\.(zip|wasm))$/;

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const { origin, pathname } = new URL(request.url);
  if (request.method !== "GET" || origin !== self.location.origin || request.cache === "no-store") return;
  const large = LARGE.test(pathname) && request.cache !== "reload";
  event.respondWith(large ? cacheFirst(request) : networkFirst(request));
});

// Pyodide asks for its files without a version.
async function cacheFirst(request) {
  const ignoreSearch = !new URL(request.url).search;
  return (await caches.match(request, { ignoreSearch })) ?? fetch(request);
}

async function networkFirst(request) {
  try {
    const response = await fetch(request);
    if (response.ok && request.cache !== "reload") (await caches.open(PAGES)).put(request, response.clone());
    return response;
  } catch {
    return (await cached(request)) ?? Response.error();
  }
}

// The page that was kept, without the words of a search, or the file of another version.
async function cached(request) {
  const address = new URL(request.url);
  if (address.pathname.endsWith("/")) address.pathname += "index.html";
  return (await caches.match(address)) ?? (await caches.match(address, { ignoreSearch: true }));
}
