// The editor of an exercise's page, with Check, which runs the public checks in this page, and Try it.
import { download as load } from "./download.js";
import { Edits } from "./edits.js";
import { createEditor } from "./editor.js";
import { after, announce, button, element, failure, hindrance, save, style } from "./elements.js";
import { fill } from "./picture.js";
import { take } from "./processes.js";
import { stopTrial, tryOut } from "./trial.js";
import { tellUpdate } from "./update.js";

const LIMIT_S = 120;
const OLDER = "You have changed your program since. This is the result of the one before: check again.";
const SIGNS = { passed: "✓", failed: "✗", blocked: "–", error: "!", untested: "○" };

// The last line of a downloaded program whose exercise counts hints. grader/report/hint_steps.py reads it.
const TAKEN = /\n# Hints shown in the page: \{.*\}\n$/;

let process = null;

// Return how many steps of hints were shown of each check of an exercise, by its title.
const taken = (exercise) => globalThis.kept(`hints:${exercise}`) ?? {};

function count(exercise, check, steps) {
  const counts = taken(exercise);
  counts[check] = Math.max(counts[check] ?? 0, steps);
  globalThis.keep(`hints:${exercise}`, counts);
}

function withCounts(text, exercise) {
  const counts = JSON.stringify(taken(exercise));
  return counts === "{}" ? text : `${text.replace(TAKEN, "")}\n# Hints shown in the page: ${counts}\n`;
}

// Return the process that checks, once it is ready. There is one per page, until it has to be ended.
async function checker(say) {
  process ??= take("check", {});
  const worker = process;
  Object.assign(worker.hears, { progress: (part) => say(`Loading ${part} …`), end: () => (process = null) });
  await worker.ready;
  return worker;
}

// Return the program in a file. The grader's own code reads it, so notebooks and archives give the same as in the grader.
async function read(exercise, file, say) {
  const content = new Uint8Array(await file.arrayBuffer());
  return (await checker(say)).call("check.read", { name: exercise, file: file.name, content });
}

async function check(exercise, source, say) {
  const worker = await checker(say);
  say("Checking …");
  const result = await Promise.race([worker.call("check.check", { name: exercise, source }), after(1000 * LIMIT_S, "late")]);
  if (result !== "late") return result;
  worker.end();
  return { problem: `The check did not finish within ${LIMIT_S} s. Is there a loop in your program that never ends?` };
}

// `shown` hears of each hint that is unfolded: the check's title, and which step it is, from 1.
function row(check, shown) {
  const { status, title, earned, points, text, facts, hints, note } = check;
  const steps = hints.map(([label, hint]) => folded(label, false, element("p", { textContent: hint })));
  steps.forEach((step, i) => step.addEventListener("toggle", () => step.open && shown(title, i + 1)));
  return element(
    "li",
    { className: `check-${status}` },
    element("span", { className: "check-sign", textContent: SIGNS[status], ariaLabel: status }),
    element("span", { className: "check-title", textContent: title }),
    element("span", { className: "check-points", textContent: `${earned} of ${points}` }),
    ...(text ? [element("p", { textContent: text })] : []),
    ...(facts.length ? [table(facts)] : []),
    ...steps,
    ...(note ? [element("p", { className: "check-note", textContent: note })] : []),
  );
}

function table(facts) {
  const rows = facts.map(([label, value]) => {
    const head = element("th", { scope: "row", textContent: label });
    return element("tr", {}, head, element("td", {}, element("code", { textContent: value })));
  });
  return element("table", { className: "check-facts" }, ...rows);
}

function folded(words, open, ...children) {
  return element("details", { open }, element("summary", { textContent: words }), ...children);
}

// The values that the node published, drawn over the solution's.
function plotted({ plot, plot_says: words, full }) {
  const figure = fill(element("figure", { className: "check-plot" }), plot, ".check-plot");
  return folded(words, !full, figure);
}

function panel(result, exercise) {
  if (result.problem) return [element("p", { className: "check-message", textContent: result.problem })];
  const { checks, points } = result.hidden;
  const later = checks ? `${checks} hidden check${checks > 1 ? "s" : ""} (${points} points) will be judged after you hand in. ` : "";
  const shown = result.counts_hints ? (title, steps) => count(exercise, title, steps) : () => {};
  const counted = result.counts_hints ? "Each hint that you unfold is counted. " : "";
  return [
    element("p", { className: "check-total", textContent: result.total }),
    ...(result.message ? [element("p", { className: "check-message", textContent: result.message })] : []),
    ...(result.step ? [element("p", { textContent: result.step })] : []),
    ...(result.log ? [folded("What your program printed", Boolean(result.message), element("pre", { textContent: result.log, tabIndex: 0 }))] : []),
    element("ul", {}, ...result.rows.map((check) => row(check, shown))),
    ...(result.plot ? [plotted(result)] : []),
    element("p", { textContent: `${counted}${later}This is a preview, not your grade: the grade is the grader's.` }),
  ];
}

let opened = null;

// Turn the starter of an exercise's page into an editor with Check; return the editor.
export function open(section) {
  opened ??= opening(section);
  return opened;
}

function opening(section) {
  style();
  const name = location.pathname.split("/").pop().replace(/\.html$/, "");
  const file = document.querySelector(".facts code").textContent;
  const code = section.querySelector("pre");
  const editor = createEditor(code, file, "python");
  code.addEventListener("click", ({ clientX: x, clientY: y }) => getSelection().isCollapsed && editor.open({ x, y }));
  const buttons = element("span", { className: "draft-tools" });
  const edits = new Edits(editor, location.pathname, file, buttons, code.closest('[class*="highlight-"]') ?? code);
  const state = element("p", { className: "run-state", role: "status" });
  const result = element("div", { className: "check-result" });
  const say = (text) => (state.textContent = text);
  // The program whose result is shown; null if no result is.
  let judged = null;
  const clear = () => {
    judged = null;
    result.replaceChildren();
    stopTrial();
  };
  edits.onchange = () => judged !== null && say(editor.text === judged ? "" : OLDER);
  // On a phone, the results are below the visible part of the page.
  const show = (part) => part.scrollIntoView({ block: "nearest" });

  // Load what runs programs, then act. Say so if something prevents it.
  const attempt = async (act) => {
    const hindered = hindrance();
    if (hindered) return say(hindered);
    tellUpdate();
    say("Starting …");
    show(state);
    try {
      await load(say);
      await act();
    } catch (error) {
      say(failure(error));
    }
  };
  const runChecks = async () => {
    const source = editor.text;
    const checked = await check(name, source, say);
    judged = source;
    edits.onchange();
    result.replaceChildren(...panel(checked, name));
    show(result);
    announce(checked.problem ?? checked.total);
  };
  const checking = button("Check", `Check ${file}`, async () => {
    // Not `disabled`, with which a button loses the focus.
    if (checking.ariaDisabled) return;
    clear();
    edits.note("checked");
    checking.ariaDisabled = "true";
    await attempt(runChecks);
    checking.ariaDisabled = null;
  });
  const play = (scenario) => {
    clear();
    edits.note("tried");
    return attempt(() => tryOut({ exercise: name, file, source: editor.text, scenario, place: result, say }));
  };
  const trying = button("Try it", `Try ${file} in real time`, () => play(""));
  result.addEventListener("play", ({ detail }) => play(detail));
  editor.onrun = () => checking.click();
  const upload = element("input", { type: "file", className: "hidden-text", tabIndex: -1, ariaLabel: "A file to continue with" });
  const take = async () => {
    const [file] = upload.files;
    upload.value = "";
    if (!file) return;
    clear();
    const text = await file.text();
    if (/\.py$/i.test(file.name) && !/^(\s*\{|PK)/.test(text)) return edits.take(text, `Your program is from ${file.name}.`);
    await attempt(async () => {
      const program = await read(name, file, say);
      say(program.problem ?? "");
      if (!program.problem) edits.take(program.source, [`Your program is from ${file.name}.`, ...program.notes].join(" "));
    });
  };
  upload.addEventListener("change", take);
  const tools = element(
    "div",
    { className: "check-tools" },
    checking,
    trying,
    button("Download", `Download your ${file}`, () => save(file, withCounts(editor.text, name))),
    button("Upload", "Continue with a file of yours", () => upload.click()),
    buttons,
    upload,
  );
  section.append(tools, state, result);
  return editor;
}
