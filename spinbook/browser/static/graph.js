// The graph of the running nodes, drawn as by the notebook's %graph, in a panel of the bar that is kept up to date.
import { button, element } from "./elements.js";
import { observer } from "./notebook.js";
import { graph } from "./picture.js";

const REFRESH_MS = 1000;

// Return a button, and a panel that shows the current graph while it is open.
export function follow() {
  const panel = element("div", { className: "graph-panel", tabIndex: 0, role: "region", ariaLabel: "Node graph" });
  const toggle = button("Graph", "Node graph", () => {
    open(panel.hidden);
    refresh();
  });
  const open = (yes) => {
    panel.hidden = !yes;
    toggle.ariaExpanded = String(yes);
  };
  open(false);
  let shown = "";
  let timer = 0;

  async function refresh() {
    clearTimeout(timer);
    if (panel.hidden) return;
    if (!shown) panel.textContent = "Loading the graph …";
    const current = await (await observer()).call("node_graph.now");
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
    open(false);
    shown = "";
  };
  return { panel, toggle, changed };
}
