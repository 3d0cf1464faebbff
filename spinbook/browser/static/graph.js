// The graph of the running nodes, drawn as the notebook's %graph; the bar's panel follows it.
import { button, element } from "./elements.js";
import { observer } from "./notebook.js";
import { graph } from "./picture.js";

const LOOK_MS = 1000;

// A button, and a panel that follows the graph while it is open.
export function follow() {
  const panel = element("div", { className: "graph-panel", hidden: true, tabIndex: 0 });
  panel.setAttribute("role", "region");
  panel.setAttribute("aria-label", "Node graph");
  const toggle = button("Graph", "Node graph", () => {
    panel.hidden = !panel.hidden;
    toggle.setAttribute("aria-expanded", String(!panel.hidden));
    look();
  });
  toggle.setAttribute("aria-expanded", "false");
  let shown = "";
  let timer = 0;

  async function look() {
    clearTimeout(timer);
    if (panel.hidden) return;
    if (!shown) panel.textContent = "Looking …";
    const found = await (await observer()).call("graph");
    if (!found || panel.hidden) return;
    if (JSON.stringify(found) !== shown) {
      shown = JSON.stringify(found);
      panel.replaceChildren(found.pictures.length ? graph(found) : "No nodes.");
    }
    clearTimeout(timer);
    timer = setTimeout(look, LOOK_MS);
  }

  const changed = (count) => {
    if (count > 0) return;
    clearTimeout(timer);
    panel.hidden = true;
    toggle.setAttribute("aria-expanded", "false");
    shown = "";
  };
  return { panel, toggle, changed };
}
