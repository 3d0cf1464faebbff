// Searches the sections of the course without a server: on the search page, and below the field while you type.
"use strict";

const MOST = 50;
const MOST_NOW = 8;

// Treat a plural and its singular as one word.
const singular = (word) => (word.length > 3 ? word.replace(/(?<=[sxz]|[cs]h)es$|ies$|(?<![su])s$/, (end) => (end === "ies" ? "y" : "")) : word);
const wordsOf = (text) => text.toLowerCase().match(/[\p{L}\p{N}_]+/gu) ?? [];
const vocabulary = new Set(courseSections.flatMap(([, page, heading, text]) => wordsOf(`${page} ${heading} ${text}`)));

// Return how many letters have to be changed, added, removed or swapped with their neighbour (optimal string alignment).
function distance(a, b) {
  let [former, row] = [[], Array.from({ length: b.length + 1 }, (_, at) => at)];
  for (let i = 1; i <= a.length; i += 1) {
    const next = [i];
    for (let j = 1; j <= b.length; j += 1) {
      next[j] = Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1));
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) next[j] = Math.min(next[j], former[j - 2] + 1);
    }
    [former, row] = [row, next];
  }
  return row[b.length];
}

// Return the words of the course that a typed word may mean: itself, or else the nearest with at most one wrong letter in four.
function meant(word) {
  const plain = singular(word);
  for (const known of vocabulary) if (known.includes(plain)) return [plain];
  const allowed = Math.min(2, Math.floor(plain.length / 4));
  const near = [...vocabulary]
    .filter((known) => Math.abs(known.length - plain.length) <= allowed)
    .map((known) => [distance(plain, singular(known)), singular(known)])
    .filter(([changes]) => changes <= allowed)
    .sort((a, b) => a[0] - b[0]);
  return near.length ? [...new Set(near.filter(([changes]) => changes === near[0][0]).map(([, known]) => known))] : [plain];
}

// Return how well a section fits; 0 if a word is missing. A heading weighs more than the text.
function weight([, page, heading, text], wanted) {
  const [inPage, inHeading, inText] = [page, heading, text].map((part) => part.toLowerCase());
  let total = 0;
  for (const alternatives of wanted) {
    const points = alternatives.map(
      (word) =>
        (inHeading.includes(word) ? 20 : 0) + (inPage.includes(word) ? 5 : 0) + Math.min(inText.split(word).length - 1, 10),
    );
    const best = Math.max(...points);
    if (best === 0) return 0;
    total += best;
  }
  return total;
}

// Return a piece of the text around the first match, with every match marked.
function excerpt(text, words) {
  const lower = text.toLowerCase();
  const first = Math.min(...words.map((word) => lower.indexOf(word)).filter((at) => at >= 0));
  const start = Number.isFinite(first) ? Math.max(0, text.lastIndexOf(" ", Math.max(0, first - 70)) + 1) : 0;
  const end = text.length > start + 220 ? text.lastIndexOf(" ", start + 220) : text.length;
  const piece = `${start > 0 ? "… " : ""}${text.slice(start, end)}${end < text.length ? " …" : ""}`;
  const paragraph = document.createElement("p");
  const pattern = new RegExp(`(${words.map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|")})`, "gi");
  piece.split(pattern).forEach((part, index) => {
    const element = index % 2 ? document.createElement("mark") : document.createTextNode("");
    element.textContent = part;
    paragraph.append(element);
  });
  return paragraph;
}

function search(asked) {
  const wanted = asked.toLowerCase().split(/\s+/).filter(Boolean).map(meant);
  const found = courseSections
    .map((section) => [weight(section, wanted), section])
    .filter(([points]) => wanted.length > 0 && points > 0)
    .sort((a, b) => b[0] - a[0]);
  return { words: wanted.flat(), sections: found.map(([, section]) => section) };
}

function items({ words, sections }, most, withText) {
  return sections.slice(0, most).map(([address, page, heading, text]) => {
    const item = document.createElement("li");
    const link = document.createElement("a");
    link.href = document.documentElement.dataset.root + address;
    link.textContent = heading || page;
    const where = document.createElement("span");
    where.className = "search-page";
    where.textContent = page;
    item.append(link, ...(heading === page ? [] : [where]));
    if (withText) item.append(excerpt(text, words));
    return item;
  });
}

// Return a sentence about the results. It names the words that were searched for instead of a misspelled one.
function inWords(asked, { words, sections }) {
  const typed = asked.toLowerCase().split(/\s+/).filter(Boolean).map(singular);
  const others = words.filter((word) => !typed.includes(word));
  const count = sections.length === 1 ? "1 result" : `${sections.length || "No"} results`;
  return others.length ? `${count} for “${others.join(" ")}”. You typed “${asked}”.` : `${count} for “${asked}”.`;
}

const field = document.getElementById("search-field");
const list = document.getElementById("search-results");
const now = document.getElementById("search-now");

function show() {
  const asked = field.value.trim();
  const found = search(asked);
  if (list) {
    list.replaceChildren(...items(found, MOST, true));
    document.getElementById("search-count").textContent = asked ? inWords(asked, found) : "";
    return;
  }
  now.hidden = asked.length < 2;
  now.replaceChildren(...items(found, MOST_NOW, false));
  document.getElementById("said").textContent = now.hidden ? "" : inWords(asked, found);
  if (!now.hidden && found.sections.length === 0) {
    const none = document.createElement("li");
    none.textContent = inWords(asked, found);
    now.append(none);
  }
}

field.addEventListener("input", show);
if (list && !field.value) field.value = new URLSearchParams(location.search).get("q") ?? "";
if (field.value) show();
