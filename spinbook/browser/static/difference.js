// Which lines differ between two texts.
import { element } from "./elements.js";

const CONTEXT = 2;

// Return the lines as [sign, text]: "-" only in the first text, "+" only in the second, " " in both. The sequence that
// they have in common is the longest (see Hunt and McIlroy, An Algorithm for Differential File Comparison, 1976).
export function difference(before, after) {
  const [a, b] = [before.trimEnd().split("\n"), after.trimEnd().split("\n")];
  const common = Array.from({ length: a.length + 1 }, () => new Uint16Array(b.length + 1));
  for (let i = a.length - 1; i >= 0; i -= 1) {
    for (let j = b.length - 1; j >= 0; j -= 1) {
      common[i][j] = a[i] === b[j] ? common[i + 1][j + 1] + 1 : Math.max(common[i + 1][j], common[i][j + 1]);
    }
  }
  const lines = [];
  let [i, j] = [0, 0];
  while (i < a.length || j < b.length) {
    if (i < a.length && j < b.length && a[i] === b[j]) lines.push([" ", a[(j++, i++)]]);
    else if (j === b.length || (i < a.length && common[i + 1][j] >= common[i][j + 1])) lines.push(["-", a[i++]]);
    else lines.push(["+", b[j++]]);
  }
  return lines;
}

const NAMES = { "-": "diff-old", "+": "diff-new", " ": "" };

// Return the changed lines with some around them, as elements.
export function shownDifference(before, after) {
  const lines = difference(before, after);
  const near = lines.map((_, at) => lines.slice(Math.max(0, at - CONTEXT), at + CONTEXT + 1).some(([sign]) => sign !== " "));
  if (!near.includes(true)) return [element("span", { textContent: "No line differs." })];
  return lines.flatMap(([sign, text], at) => {
    if (near[at]) return [element("span", { className: NAMES[sign], textContent: `${sign} ${text}\n` })];
    return near[at - 1] || (at === 0 && near.includes(true)) ? [element("span", { className: "diff-gap", textContent: "  …\n" })] : [];
  });
}
