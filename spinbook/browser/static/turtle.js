// Turtlesim's window: its picture four times per second, and the arrow keys.
import { Process } from "./processes.js";
import { draw } from "./picture.js";

const PIXELS = 45;
const KEYS = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };
const colour = ([r, g, b]) => `rgb(${r}, ${g}, ${b})`;

function paint(svg, { size, background, turtles, trails }) {
  const side = size * PIXELS;
  const at = (x, y) => `${(x * PIXELS).toFixed(1)},${((size - y) * PIXELS).toFixed(1)}`;
  svg.setAttribute("viewBox", `0 0 ${side} ${side}`);
  const lines = trails.map((trail) =>
    draw("polyline", {
      points: trail.points.map(([x, y]) => at(x, y)).join(" "),
      fill: "none",
      stroke: colour(trail.color),
      "stroke-width": trail.width,
    }),
  );
  const bodies = turtles.map(({ x, y, theta }) =>
    draw("path", {
      d: "M 20 0 L -14 -12 L -8 0 L -14 12 Z",
      fill: "#2e8b57",
      stroke: "#ffffff",
      transform: `translate(${at(x, y)}) rotate(${(-theta * 180) / Math.PI})`,
    }),
  );
  svg.replaceChildren(draw("rect", { width: side, height: side, fill: colour(background) }), ...lines, ...bodies);
  const where = turtles.map((turtle) => `${turtle.name} at ${turtle.x.toFixed(1)}, ${turtle.y.toFixed(1)}`).join("; ");
  svg.setAttribute("aria-label", `Turtlesim: ${where || "no turtle"}`);
}

// Return a figure that shows the running turtlesim until `until` resolves.
export function turtle(until) {
  const figure = document.createElement("figure");
  figure.className = "turtle";
  const svg = draw("svg", { role: "img", tabindex: "0", "aria-label": "Turtlesim" });
  const words = document.createElement("figcaption");
  words.textContent = "Click the picture, then drive with the arrow keys.";
  figure.append(svg, words);
  const process = new Process("turtle window", { picture: (text) => paint(svg, JSON.parse(text)) });
  process.ready.then(() => process.call("turtle")).catch((error) => (words.textContent = error.message));
  svg.addEventListener("keydown", (event) => {
    if (!KEYS[event.key]) return;
    event.preventDefault();
    process.worker.postMessage({ op: "key", ahead: KEYS[event.key][0], left: KEYS[event.key][1] });
  });
  until.then(() => process.end());
  return figure;
}
