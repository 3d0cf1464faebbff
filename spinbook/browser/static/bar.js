// The bar below a page: what runs, with one Stop for each node, terminal and launch, Stop for all, and the node graph.
import { button, element } from "./elements.js";
import { follow } from "./graph.js";
import { changes, running, working } from "./processes.js";

let place = null;
// The head in which the reader has pressed a button, and from which he has not scrolled since.
let pressed = null;

// Show the bar from now on, whenever something runs.
export function bar() {
  if (place) return;
  place = document.body.appendChild(element("div", { className: "running", hidden: true, role: "region", ariaLabel: "Running nodes" }));
  const list = element("ul");
  const every = button("Stop all", "Stop all nodes", () => Promise.all(entries().map((each) => each.stop())));
  const graph = follow();
  place.append(graph.panel, element("span", { className: "running-title", textContent: "Running" }), list, graph.toggle, every);
  changes.addEventListener("change", () => fill(list, graph));
  const measure = () => {
    document.documentElement.style.setProperty("--running", `${place.offsetHeight}px`);
    uncover();
  };
  const observer = new ResizeObserver(measure);
  observer.observe(place);
  // Output above a head moves it, too.
  observer.observe(document.body);
  const press = (target) => (pressed = target?.closest(".cell-head, .check-tools"));
  press(document.activeElement);
  for (const scroll of ["wheel", "touchmove", "pointerdown", "keydown"]) addEventListener(scroll, () => press(null), { passive: true });
  addEventListener("click", ({ target }) => press(target));
}

// What runs, one entry for each launch, however many nodes it has.
const entries = () => [...new Set([...running().map((process) => process.launch ?? process), ...working()])];

// Scroll so that the bar does not cover the pressed head.
function uncover() {
  if (!pressed || place.hidden) return;
  const covered = pressed.getBoundingClientRect().bottom - place.getBoundingClientRect().top;
  if (covered > 0) scrollBy({ top: covered + 8, behavior: "instant" });
}

function fill(list, graph) {
  const nodes = entries();
  place.hidden = nodes.length === 0;
  document.body.classList.toggle("has-running", !place.hidden);
  // Buttons that stay are not replaced, so that they keep the focus.
  const there = new Map([...list.children].map((item) => [item.dataset.key, item]));
  const items = nodes.map((node) => there.get(key(node)) ?? item(node));
  if (items.length !== list.children.length || items.some((each) => !each.isConnected)) list.replaceChildren(...items);
  graph.changed(nodes.length);
}

const key = (node) => `${node.identity} ${node.task ?? ""}`;

function item(node) {
  const name = node.task || node.name;
  const made = element("li", {}, element("span", { textContent: name }), button("Stop", `Stop ${name}`, () => node.stop()));
  made.dataset.key = key(node);
  return made;
}
