// Adds a Run button to each cell that can run. Everything else is loaded when the first one is pressed.
"use strict";

(() => {
  const places = [...document.querySelectorAll("main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)")];
  const load = (name) => import(new URL(`${document.documentElement.dataset.root}run/${name}`, location.href));

  function add(place, module, text, label, act) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "run-button";
    button.textContent = text;
    button.setAttribute("aria-label", label);
    button.addEventListener("click", async () => {
      try {
        await act(await load(module), button);
      } catch {
        document.getElementById("said").textContent = "Nodes can't run in a page that is opened from a file.";
        button.textContent = "Only on a website";
      }
    });
    place?.prepend(button);
  }

  for (const [index, cell] of places.entries()) {
    const name = cell.querySelector(".cell-file")?.textContent ?? `cell ${index + 1}`;
    const links = cell.querySelector(".cell-links");
    if (index > 0) {
      add(links, "page.js", "Run all above", `Run all above ${name}`, async (page, button) => {
        button.disabled = true;
        await page.runAbove(cell);
        button.disabled = false;
      });
    }
    add(links, "page.js", "Run", `Run ${name}`, (page) => page.run(cell));
  }
  const starter = document.querySelector("body.kind-exercise main #starter");
  if (starter) {
    add(starter.querySelector("p"), "exercise.js", "Edit and check here", "Edit and check the starter here", (page, button) => {
      button.remove();
      page.open(starter).focus();
    });
  }
})();
