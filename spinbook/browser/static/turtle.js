// Turtlesim's window: its picture four times per second, and the arrow keys. One process draws for all places.
import { element } from "./elements.js";
import { take } from "./processes.js";

const KEYS = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };

let painter = null;
const figures = new Set();

function paint({ svg, words }) {
  for (const figure of figures) {
    if (figure.isConnected) figure.paint(svg, words);
    else figures.delete(figure);
  }
  // Nobody looks any more.
  if (figures.size === 0) painter.end();
}

// Return the process that asks turtlesim `node` for its picture; it ends with it.
function painterOf(node) {
  if (painter?.alive) return painter;
  const process = take("turtle window", { picture: (text) => paint(JSON.parse(text)) });
  painter = process;
  process.ready.then(() => process.call("turtle.show")).catch((error) => figures.forEach((figure) => figure.say(error.message)));
  node.ended.then(() => {
    process.end();
    figures.forEach((figure) => figure.say("turtlesim has ended."));
    figures.clear();
  });
  return process;
}

// Return a figure that shows the running turtlesim `node`.
export function turtle(node) {
  const picture = element("div", { className: "turtle-picture", tabIndex: 0, role: "img", ariaLabel: "Turtlesim" });
  const caption = element("figcaption", { textContent: "Loading the picture …" });
  const figure = element("figure", { className: "turtle" }, picture, caption);
  figure.say = (text) => (caption.textContent = text);
  figure.paint = (svg, words) => {
    if (!picture.firstChild) figure.say("Click the picture, then drive with the arrow keys.");
    // Drawn by Spinbook's own code, which escapes names.
    picture.innerHTML = svg;
    picture.ariaLabel = `Turtlesim: ${words}`;
  };
  picture.addEventListener("keydown", (event) => {
    if (!KEYS[event.key] || !picture.firstChild || !figures.has(figure)) return;
    event.preventDefault();
    const [ahead, left] = KEYS[event.key];
    painter.worker.postMessage({ op: "key", ahead, left });
  });
  painterOf(node);
  figures.add(figure);
  return figure;
}
