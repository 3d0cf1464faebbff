// Adds a Run button to each cell that can run. Everything else is loaded when the first one is pressed, or at once if
// the reader has edited something on this page, so that what is shown is what runs.
"use strict";

(() => {
  const places = [...document.querySelectorAll("main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)")];
  const version = new URL(document.currentScript.src).search;
  const load = (name) => import(new URL(`${document.documentElement.dataset.root}run/${name}${version}`, location.href));

  // Return why a script can't be loaded.
  async function why() {
    if (location.protocol === "file:") return ["Only on a website", "Nodes can't run in a page that is opened from a file."];
    const answer = await fetch(new URL(`${document.documentElement.dataset.root}version.txt`, location.href), { cache: "no-store" }).catch(() => null);
    if (answer?.ok && `?v=${await answer.text()}` !== version) return ["Reload the page", "This course was updated: reload the page."];
    return ["No connection", "It could not be loaded: this course's website does not answer. Check the network, and reload the page."];
  }

  function add(place, module, text, label, act) {
    const button = newButton("run-button", text, label);
    button.addEventListener("click", async () => {
      let loaded = null;
      try {
        loaded = await load(module);
      } catch {
        [button.textContent, document.getElementById("said").textContent] = await why();
      }
      if (loaded) await act(loaded, button);
    });
    // A reader who points at the button is likely to press it.
    const near = () => navigator.connection?.saveData || load("download.js").then((page) => page.prepare()).catch(() => {});
    ["pointerenter", "focus"].forEach((event) => button.addEventListener(event, near, { once: true }));
    place?.prepend(button);
    return button;
  }

  const sectionOf = (cell) => cell?.closest("section:has(> h2)");
  for (const [index, cell] of places.entries()) {
    const name = cell.querySelector(".cell-file")?.textContent ?? `cell ${index + 1}`;
    // Once in each section.
    if (index > 0 && sectionOf(cell) !== sectionOf(places[index - 1])) {
      add(cell.querySelector(".places"), "page.js", "Run all above", `Run all above ${name}`, async (page, button) => {
        button.disabled = true;
        await page.runAbove(cell);
        button.disabled = false;
      });
    }
    const run = (page) => (keep("has-run", true), page.run(cell));
    add(cell.querySelector(".cell-links"), "page.js", "Run", `Run ${name}`, run).classList.add("play");
    // A click into the code edits it. Who selects some of it wants to copy.
    const edit = ({ clientX: x, clientY: y }) => getSelection().isCollapsed && load("page.js").then((page) => page.edit(cell, { x, y }), () => {});
    cell.querySelector(".cell_input pre, .highlight pre")?.addEventListener("click", edit);
  }
  // Who has never run anything can't know that it works in the page.
  if (places.length > 0 && !kept("has-run")) {
    const hint = document.createElement("p");
    hint.className = "run-hint";
    hint.textContent = "Run starts a program here, in your browser. The first time, it downloads ROS 2. To change the code, click into it.";
    places[0].before(hint);
  }
  // Who has run nodes of this course before gets a process while reading. Nothing has to be loaded from the website.
  const near = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    near.disconnect();
    load("processes.js").then((page) => page.prepared(), () => {});
  });
  const isKept = self.caches?.has(`run-${version.slice("?v=".length)}`);
  isKept?.then((is) => is && places.forEach((cell) => near.observe(cell)), () => {});
  const starter = document.querySelector("body.kind-exercise main #starter");
  if (starter) {
    add(starter.querySelector("p:has(.button)"), "exercise.js", "Edit and check here", "Edit and check the starter here", (page, button) => {
      button.remove();
      page.open(starter).open();
    }).className = "button";
  }

  let drafts = [];
  try {
    drafts = Object.keys(localStorage).filter((key) => key.startsWith(`code:${location.pathname}`));
  } catch {
    // Nothing can be stored.
  }
  if (drafts.length && (starter || places.length)) load(starter ? "exercise.js" : "page.js").then((page) => page.open(starter), () => {});
})();
