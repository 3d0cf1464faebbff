// Gives each cell that can run a Run button. All else is loaded when the first one is pressed.
"use strict";

(() => {
  const places = [...document.querySelectorAll("main .cell:is(.cell-node, .cell-shell, .cell-snippet)")];
  const load = () => import(new URL(`${document.documentElement.dataset.root}run/page.js`, location.href));

  function add(cell, text, label, act) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "run-button";
    button.textContent = text;
    button.setAttribute("aria-label", label);
    button.addEventListener("click", async () => {
      try {
        act(await load());
      } catch {
        document.getElementById("said").textContent = "Nodes can't run in a page that is opened from a file.";
        button.textContent = "Only on a website";
      }
    });
    cell.querySelector(".cell-links")?.prepend(button);
  }

  for (const [index, cell] of places.entries()) {
    const name = cell.querySelector(".cell-file")?.textContent ?? `cell ${index + 1}`;
    add(cell, "Run", `Run ${name}`, (page) => page.run(cell));
  }
})();
