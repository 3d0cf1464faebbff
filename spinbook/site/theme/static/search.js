// Searches the sections of the course for words, without a server.
"use strict";

const asked = new URLSearchParams(location.search).get("q") ?? "";
const wanted = asked.toLowerCase().split(/\s+/).filter(Boolean);
const count = document.getElementById("search-count");
const list = document.getElementById("search-results");
const MOST = 50;

// How well a section fits: every word must be in it; a heading weighs more than the text.
function weight([, page, heading, text]) {
  let total = 0;
  for (const word of wanted) {
    const inHeading = heading.toLowerCase().includes(word) ? 20 : 0;
    const inPage = page.toLowerCase().includes(word) ? 5 : 0;
    const inText = Math.min(text.toLowerCase().split(word).length - 1, 10);
    if (inHeading + inPage + inText === 0) return 0;
    total += inHeading + inPage + inText;
  }
  return total;
}

// A piece of the text around the first word that was found, with every found word marked.
function excerpt(text) {
  const lower = text.toLowerCase();
  const first = Math.min(...wanted.map((word) => lower.indexOf(word)).filter((at) => at >= 0));
  const start = Number.isFinite(first) ? Math.max(0, text.lastIndexOf(" ", Math.max(0, first - 70)) + 1) : 0;
  const piece = `${start > 0 ? "… " : ""}${text.slice(start, start + 220)}${text.length > start + 220 ? " …" : ""}`;
  const paragraph = document.createElement("p");
  const pattern = new RegExp(`(${wanted.map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|")})`, "gi");
  piece.split(pattern).forEach((part, index) => {
    const element = index % 2 ? document.createElement("mark") : document.createTextNode("");
    element.textContent = part;
    paragraph.append(element);
  });
  return paragraph;
}

if (wanted.length > 0) {
  document.getElementById("search-field").value = asked;
  const found = courseSections
    .map((section) => [weight(section), section])
    .filter(([points]) => points > 0)
    .sort((a, b) => b[0] - a[0]);
  const places = found.length === 1 ? "1 place" : `${found.length} places`;
  count.textContent = found.length ? `“${asked}” is in ${places}.` : `“${asked}” is nowhere in the course.`;
  for (const [, [address, page, heading, text]] of found.slice(0, MOST)) {
    const item = document.createElement("li");
    const link = document.createElement("a");
    link.href = document.documentElement.dataset.root + address;
    link.textContent = heading || page;
    const where = document.createElement("span");
    where.className = "search-page";
    where.textContent = heading === page ? "" : page;
    item.append(link, where, excerpt(text));
    list.append(item);
  }
}
