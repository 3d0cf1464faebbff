// Shows the SVG pictures that Spinbook draws.
import { element } from "./elements.js";

function dress(rules) {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(rules);
  document.adoptedStyleSheets.push(sheet);
}

// Show a picture in a cell, or its words if there is nothing to draw, or the problem.
export function show(cell, { picture, words, problem }, className) {
  if (problem) return cell.fail(problem);
  if (!picture) return cell.print(words);
  const figure = element("figure", { className: `live-picture ${className}` });
  // Names in it are escaped. The page's policy forbids <style>, so its rules go into a constructed style sheet.
  figure.innerHTML = picture.replace(/<style>(.*?)<\/style>/gs, (_, rules) => (dress(rules), ""));
  figure.dataset.words = words;
  cell.shown?.append(figure);
}

// Return a figure with a picture for each part of the graph.
export function graph({ pictures, words }) {
  const figure = element("figure", { className: "node-graph live-graph" });
  // Drawn by Spinbook's own code, which escapes names.
  figure.innerHTML = pictures.join("");
  figure.dataset.words = words;
  return figure;
}
