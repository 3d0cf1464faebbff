// A plot of recorded values over time, as SVG.

const NS = "http://www.w3.org/2000/svg";
// How wide a plot may be: on a phone it is as wide as the phone, so that its words stay as large.
const [NARROW, WIDE] = [300, 640];
const HEIGHT = 280;
const EDGE = { left: 56, right: 12, top: 12, bottom: 36 };

export function draw(tag, attributes, text = "") {
  const made = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

// Round steps that give about `count` of them between low and high.
function steps(low, high, count) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= raw);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + step * 1e-9; at += step) found.push(Number(at.toPrecision(6)));
  return found;
}

// A figure of the lines; `room` is how wide it may be, in pixels.
export function plot(lines, seconds, room) {
  const width = Math.max(NARROW, Math.min(WIDE, room));
  const values = lines.flatMap((line) => line.values);
  const figure = document.createElement("figure");
  figure.className = "plot";
  if (values.length === 0) {
    figure.textContent = "Nothing was published on these topics. Run the node that publishes them first.";
    return figure;
  }
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const margin = (high - low || 1) * 0.05;
  const x = (time) => EDGE.left + (time / seconds) * (width - EDGE.left - EDGE.right);
  const y = (value) =>
    HEIGHT - EDGE.bottom - ((value - low + margin) / (high - low + 2 * margin)) * (HEIGHT - EDGE.top - EDGE.bottom);
  const svg = draw("svg", { viewBox: `0 0 ${width} ${HEIGHT}`, role: "img" });
  svg.setAttribute("aria-label", `${lines.map((line) => line.name).join(", ")} over ${seconds} s, from ${low} to ${high}`);
  for (const at of steps(low - margin, high + margin, 5)) {
    svg.append(draw("line", { class: "grid", x1: EDGE.left, x2: width - EDGE.right, y1: y(at), y2: y(at) }));
    svg.append(draw("text", { x: EDGE.left - 6, y: y(at) + 4, "text-anchor": "end" }, String(at)));
  }
  for (const at of steps(0, seconds, 6)) {
    svg.append(draw("text", { x: x(at), y: HEIGHT - EDGE.bottom + 16, "text-anchor": "middle" }, String(at)));
  }
  svg.append(draw("text", { x: width / 2, y: HEIGHT - 4, "text-anchor": "middle" }, "time (s)"));
  lines.forEach((line, index) => {
    const points = line.times.map((time, n) => `${x(time).toFixed(1)},${y(line.values[n]).toFixed(1)}`).join(" ");
    svg.append(draw("polyline", { class: `line line-${index % 6}`, points, fill: "none" }));
  });
  const key = document.createElement("figcaption");
  lines.forEach((line, index) => {
    const item = document.createElement("span");
    item.className = `key line-${index % 6}`;
    item.textContent = line.name;
    key.append(item);
  });
  figure.append(svg, key);
  return figure;
}
