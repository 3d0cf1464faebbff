// Shows the SVG pictures that Spinbook draws.
import { element } from "./elements.js";

const DARK = /@media[^{]*\(prefers-color-scheme:\s*dark\)\s*\{/g;
const dressed = new Set();

// Adopt the rules of a picture, once, for the elements in `scope` if it is given. Colours follow the page's own switch.
function dress(rules, scope) {
  const own = rules.replace(DARK, scope ? ':root[data-colours="dark"] & {' : ':root[data-colours="dark"] {');
  const whole = scope ? `${scope} {${own}}` : own;
  if (dressed.has(whole)) return;
  dressed.add(whole);
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(whole);
  document.adoptedStyleSheets.push(sheet);
}

// Put an SVG into an element. Names in it are escaped. The page's policy forbids <style>, so its rules go into a
// constructed style sheet.
export function fill(place, svg, scope = "") {
  place.innerHTML = svg.replace(/<style>(.*?)<\/style>/gs, (_, rules) => (dress(rules, scope), ""));
  return place;
}

// Show a picture in a cell, or its words if there is nothing to draw, or the problem.
export function show(cell, { picture, words, problem }, className) {
  if (problem) return cell.fail(problem);
  if (!picture) return cell.print(words);
  const figure = element("figure", { className: `live-picture ${className}` });
  fill(figure, picture);
  figure.dataset.words = words;
  if (picture.includes("@keyframes")) figure.append(globalThis.pauseButton(figure));
  cell.shown?.append(figure);
  globalThis.sideways.observe(figure);
}

// Return a figure with a picture for each part of the graph.
export function graph({ pictures, words }) {
  const figure = element("figure", { className: "node-graph live-graph" });
  // Drawn by Spinbook's own code, which escapes names.
  figure.innerHTML = pictures.join("");
  figure.dataset.words = words;
  return figure;
}
