// The graph of the running nodes, drawn as by the notebook's %graph, in a panel of the bar that is kept up to date.
import { button, element } from "./elements.js";
import { observer } from "./notebook.js";
import { graph } from "./picture.js";

const REFRESH_MS = 1000;

// Return a button, and a panel that shows the current graph while it is open.
export function follow() {
  const panel = element("div", { className: "graph-panel", hidden: true, tabIndex: 0 });
  panel.setAttribute("role", "region");
  panel.setAttribute("aria-label", "Node graph");
  const toggle = button("Graph", "Node graph", () => {
    panel.hidden = !panel.hidden;
    toggle.setAttribute("aria-expanded", String(!panel.hidden));
    refresh();
  });
  toggle.setAttribute("aria-expanded", "false");
  let shown = "";
  let timer = 0;

  async function refresh() {
    clearTimeout(timer);
    if (panel.hidden) return;
    if (!shown) panel.textContent = "Loading the graph …";
    const current = await (await observer()).call("graph");
    if (!current || panel.hidden) return;
    if (JSON.stringify(current) !== shown) {
      shown = JSON.stringify(current);
      panel.replaceChildren(current.pictures.length ? graph(current) : "No nodes.");
    }
    clearTimeout(timer);
    timer = setTimeout(refresh, REFRESH_MS);
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
