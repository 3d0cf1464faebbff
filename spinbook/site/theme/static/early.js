// Runs before the first paint, so that no page flashes in the wrong colours.
"use strict";
(() => {
  let chosen = null;
  let isWhole = false;
  try {
    chosen = localStorage.getItem("colours")?.replaceAll('"', "");
    isWhole = localStorage.getItem("parts-whole") === "true";
  } catch {
    // Without storage, the page follows the system's setting.
  }
  const system = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  document.documentElement.dataset.colours = chosen === "dark" || chosen === "light" ? chosen : system;
  document.documentElement.classList.add("js");
  document.documentElement.classList.toggle("whole-chapter", isWhole);
})();
