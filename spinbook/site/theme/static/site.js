// The behaviour of pages: colours, the menu on phones, copying, scrolling and more. Pages are readable without it.
"use strict";

const root = document.documentElement;
const said = document.getElementById("said");
// As in this script's own address, so that no cache gives others that are older.
const version = new URL(document.currentScript.src).search;

function newButton(className, text = "", label = "") {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", className, textContent: text, ariaLabel: label });
  return button;
}

function colours() {
  const button = document.querySelector(".theme-button");
  const show = () => button.setAttribute("aria-pressed", String(root.dataset.colours === "dark"));
  show();
  button.addEventListener("click", () => {
    root.dataset.colours = root.dataset.colours === "dark" ? "light" : "dark";
    keep("colours", root.dataset.colours);
    show();
  });
}

const MENU = "details:is(.run, .more)[open]";

function leave(menu) {
  menu.open = false;
  menu.querySelector("summary").focus({ preventScroll: true });
}

function menu() {
  const button = document.querySelector(".menu-button");
  const open = (yes) => {
    root.classList.toggle("menu-open", yes);
    button.setAttribute("aria-expanded", String(yes));
  };
  button.addEventListener("click", () => open(!root.classList.contains("menu-open")));
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    if (root.classList.contains("menu-open")) {
      open(false);
      button.focus();
    }
    for (const menu of document.querySelectorAll(MENU)) leave(menu);
  });
  document.addEventListener("click", ({ target }) => {
    for (const menu of document.querySelectorAll(MENU)) {
      if (!menu.contains(target)) menu.open = false;
      else if (target.closest(".places :is(a, button):not(.copy)")) leave(menu);
    }
  });
}

// Show, or fold, a program's main() that is as before.
function unfolding() {
  for (const button of document.querySelectorAll(".unfold")) {
    button.addEventListener("click", () => button.setAttribute("aria-expanded", button.getAttribute("aria-expanded") === "false"));
  }
}

async function toClipboard(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Without a secure connection, only the deprecated way of copying works.
    const field = document.createElement("textarea");
    field.value = text;
    field.className = "hidden-text";
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  }
}

function copying() {
  // Where there is little room, the button would cover code: it is in the menu of the block's head.
  const isSmall = matchMedia("(hover: none), (max-width: 40rem)").matches;
  for (const code of document.querySelectorAll("main .highlight > pre")) {
    if (code.closest(".cell_output, .shown")) continue;
    const cell = code.closest(".cell");
    const file = cell?.querySelector(".cell-file")?.textContent;
    const button = newButton("copy", "Copy", file ? `Copy ${file}` : "Copy this code");
    button.addEventListener("click", async () => {
      const done = await toClipboard(code.textContent.replace(/\n$/, ""));
      button.textContent = done ? "Copied" : "Not copied";
      said.textContent = done ? "Copied" : "Your browser does not allow copying";
      setTimeout(() => {
        button.textContent = "Copy";
        said.textContent = "";
      }, 2000);
    });
    ((isSmall && cell?.querySelector(".places")) || code.parentElement).append(button);
  }
}

// Elements that scroll sideways must be reachable with the keyboard; those that don't must not take the focus.
globalThis.sideways = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    const scrolls = target.scrollWidth > target.clientWidth + 1;
    if (scrolls) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
    target.role = scrolls ? "group" : null;
    target.ariaLabel = scrolls ? (target.matches("pre") ? "Code, scrolls sideways" : "Scrolls sideways") : null;
  }
});

// Mark the current section in the list next to the text.
function whereabouts() {
  const sections = new Map();
  for (const link of document.querySelectorAll(".page-toc a[href^='#']")) sections.set(document.getElementById(link.hash.slice(1)), link);
  sections.delete(null); // the page itself
  const all = [...sections.keys()];
  const seen = new Set();
  const observer = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) seen[entry.isIntersecting ? "add" : "delete"](entry.target);
      // At the top of a part, the first of its sections is the one to come.
      const at = all.filter((each) => seen.has(each)).pop() ?? all.find((each) => each.checkVisibility());
      for (const [section, link] of sections) link.ariaCurrent = section === at ? "true" : null;
    },
    { rootMargin: "-80px 0px -70% 0px" },
  );
  for (const section of all) observer.observe(section);
}

// Load one of the site's scripts. Resolves when it has run.
const load = (name) =>
  new Promise((done) => {
    const script = document.createElement("script");
    script.src = `${root.dataset.root}_static/${name}${version}`;
    script.addEventListener("load", done);
    document.head.append(script);
  });

// Let a robot move in `place`: its script is loaded for the first one that comes into view.
let robotView = null;
async function moveRobot(place, data) {
  await (robotView ??= load("robot_view.js"));
  return showRobot(place, data);
}

function robots() {
  const observer = new IntersectionObserver(
    (entries) => {
      for (const { target, isIntersecting } of entries) {
        if (!isIntersecting) continue;
        observer.unobserve(target);
        moveRobot(target, JSON.parse(target.querySelector("script").textContent));
      }
    },
    { rootMargin: "300px" },
  );
  for (const place of document.querySelectorAll("main .robot")) observer.observe(place);
}

// Load the search data when the reader begins to search. "/" focuses the search field, except while typing.
function searching() {
  const field = document.getElementById("search-field");
  const now = document.getElementById("search-now");
  const isThere = document.querySelector('script[src$="search.js"]') !== null;
  if (!isThere) {
    field.addEventListener("focus", () => load("search-data.js").then(() => load("search.js")), { once: true });
  }
  document.addEventListener("keydown", (event) => {
    const isTyping = event.target.closest("input, textarea, select, [contenteditable]");
    if (event.key === "/" && !isTyping && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      field.focus();
    } else if (event.key === "Escape" && !now.hidden) {
      now.hidden = true;
      field.focus();
    } else if (event.key === "ArrowDown" && event.target === field && !now.hidden) {
      event.preventDefault();
      now.querySelector("a")?.focus();
    }
  });
  document.addEventListener("click", (event) => {
    if (!event.target.closest(".search")) now.hidden = true;
  });
}

// Return a button that pauses what moves in `frame` (WCAG 2.2.2): it has the class "paused" then.
function pauseButton(frame) {
  const button = newButton("pause");
  const show = (paused) => {
    button.textContent = paused ? "Play" : "Pause";
    button.ariaLabel = `${button.textContent} this picture`;
  };
  button.addEventListener("click", () => show(frame.classList.toggle("paused")));
  show(false);
  return button;
}

// Let readers pause recorded pictures: a still picture takes their place.
function pausing() {
  for (const picture of document.querySelectorAll("main img.moving")) {
    const still = picture.parentElement.querySelector("img.still");
    if (!still) continue;
    const frame = document.createElement("span");
    frame.className = "pausable";
    picture.before(frame);
    frame.append(picture, still, pauseButton(frame));
  }
}

// What this browser keeps for the reader; without storage, nothing.
function kept(key) {
  try {
    return JSON.parse(localStorage.getItem(key)) ?? null;
  } catch {
    return null;
  }
}

function keep(key, value) {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    // What is not kept holds until the reader leaves.
  }
}

// The parts of a chapter: one is shown, which the address names (`#part-2`, or any anchor in it). The browser's search
// finds words in the others, where it knows hidden="until-found", and shows their part.
const parts = [...document.querySelectorAll("main .part")];
let part = parts[0];

function chapterParts() {
  if (!part) return;
  const place = `parts:${location.pathname}`;
  const { read = [], last } = kept(place) ?? {};
  const whole = document.querySelector(".pages .whole");
  const row = document.querySelector(".pages ol");
  const link = (id) => row.querySelector(`a[href="#${id}"]`);
  let isWhole = root.classList.contains("whole-chapter");

  const show = (next) => {
    if (next !== part) said.textContent = next.getAttribute("aria-label");
    part = next;
    for (const each of parts) {
      if (each === part) each.removeAttribute("hidden");
      else each.setAttribute("hidden", "until-found");
      link(each.id).ariaCurrent = each === part && !isWhole ? "page" : null;
    }
    row.scrollLeft = link(part.id).offsetLeft - row.offsetLeft - row.clientWidth / 2;
    whole.setAttribute("aria-pressed", String(isWhole));
    root.classList.toggle("whole-chapter", isWhole);
    dispatchEvent(new Event("resize"));
  };
  const follow = () => {
    const target = location.hash ? document.getElementById(location.hash.slice(1)) : parts[0];
    const next = target?.closest(".part");
    if (!next) return;
    show(next);
    if (location.hash) target.scrollIntoView();
    keep(place, { read, last: part.id });
  };
  const finished = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const { id } = target.closest(".part");
      if (!isIntersecting || read.includes(id)) continue;
      read.push(id);
      link(id).classList.add("is-read");
      keep(place, { read, last: part.id });
    }
  });
  for (const steps of document.querySelectorAll(".part > .steps")) finished.observe(steps);
  for (const id of read) link(id)?.classList.add("is-read");
  if (!location.hash && last) link(last)?.classList.add("is-last");
  addEventListener("hashchange", follow);
  document.addEventListener("beforematch", (event) => show(event.target.closest(".part") ?? part));
  whole.addEventListener("click", () => {
    isWhole = !isWhole;
    keep("parts-whole", isWhole);
    show(part);
    part.scrollIntoView();
  });
  show(part);
  if (location.hash) follow();
  root.classList.add("has-parts");
}

// Guesses, which are kept by their question: choosing one opens the answer.
function guesses() {
  const place = `guesses:${location.pathname}`;
  for (const guess of document.querySelectorAll("main .guess")) {
    const { question, right } = guess.dataset;
    const choose = (input) => {
      const words = input.value === "?" ? "" : `You guessed: ${input.value}. `;
      guess.querySelector(".guess-told").textContent = words && words + (input.value === right ? "That is right." : "See the answer.");
      guess.querySelector("details.answer").open = true;
    };
    guess.addEventListener("change", ({ target }) => {
      if (!target.matches("[type=radio]")) return;
      keep(place, { ...kept(place), [question]: target.value });
      choose(target);
    });
    const before = [...guess.querySelectorAll("[type=radio]")].find((input) => input.value === kept(place)?.[question]);
    if (before) {
      before.checked = true;
      choose(before);
    }
  }
}

// On the home page: how many pages of each chapter have been read.
function partsRead() {
  for (const place of document.querySelectorAll("[data-parts-of]")) {
    const read = kept(`parts:${new URL(place.dataset.partsOf, location.href).pathname}`)?.read ?? [];
    if (read.length) place.append(` · ${read.length} page${read.length > 1 ? "s" : ""} read`);
  }
}

// Show how far the reader has read.
function progress() {
  const bar = document.querySelector("progress.reading");
  if (!bar) return;
  const show = () => {
    const length = root.scrollHeight - innerHeight;
    const [at, count] = part && !root.classList.contains("whole-chapter") ? [parts.indexOf(part), parts.length] : [0, 1];
    bar.value = Math.round((1000 * (at + (length > 0 ? scrollY / length : 1))) / count);
  };
  addEventListener("scroll", show, { passive: true });
  addEventListener("resize", show);
  show();
}

colours();
unfolding();
searching();
chapterParts();
guesses();
partsRead();
pausing();
robots();
progress();
menu();
copying();
for (const place of document.querySelectorAll("main pre, .table, figure.drawing, .math, .pausable")) sideways.observe(place);
whereabouts();
