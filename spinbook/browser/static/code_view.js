// CodeMirror, set up for programs in a page: colours, keys, completion, and errors before the code runs.
import { completions, problems } from "./advice.js";
import * as mirror from "./codemirror.js";
import { element } from "./elements.js";

const { EditorView, tags } = mirror;
const UNDERLINE_MS = 500;

// The same classes as in code that is not edited: see site.css.
const colours = mirror.tagHighlighter([
  { tag: [tags.keyword, tags.operatorKeyword, tags.controlKeyword, tags.bool, tags.null], class: "k" },
  { tag: [tags.string, tags.special(tags.string)], class: "s" },
  { tag: tags.number, class: "m" },
  { tag: tags.comment, class: "c" },
  { tag: [tags.definition(tags.function(tags.variableName)), tags.definition(tags.className), tags.meta, tags.self], class: "nf" },
]);

const box = { backgroundColor: "var(--paper)", color: "var(--ink)", border: "1px solid var(--edge)", borderRadius: "0.4rem" };
const look = EditorView.theme({
  "&": { fontSize: "inherit", backgroundColor: "var(--code)", color: "var(--ink)" },
  "&.cm-focused": { outline: "none" },
  ".cm-scroller": { fontFamily: "var(--letters)", lineHeight: "1.55" },
  ".cm-content": { padding: "0.9rem 0", caretColor: "var(--ink)" },
  ".cm-line": { padding: "0 1.1rem 0 0.6rem" },
  ".cm-gutters": { backgroundColor: "var(--code)", color: "var(--soft)", border: "0" },
  ".cm-gutterElement": { fontSize: "0.8em", lineHeight: "1.9375" },
  ".cm-lineNumbers .cm-gutterElement": { minWidth: "1rem", padding: "0 0.15rem 0 0.3rem" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { background: "var(--tint)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "transparent", outline: "1px solid var(--accent)" },
  "&.cm-focused .cm-nonmatchingBracket": { backgroundColor: "transparent", color: "var(--c-error)" },
  ".cm-tooltip": box,
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "var(--letters)", maxWidth: "calc(100vw - 2rem)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { background: "var(--accent)", color: "var(--paper)" },
  ".cm-completionDetail": { color: "inherit" },
  ".cm-diagnostic-error": { borderLeftColor: "var(--c-error)" },
  ".cm-lintRange-error": { background: "none", textDecoration: "underline wavy var(--c-error)", textUnderlineOffset: "0.2em" },
});

// Edit `text` in `parent`; `onchange` gets each new text.
export function codeView({ parent, text, label, language, before, onchange }) {
  const isPhone = matchMedia("(max-width: 40rem)").matches;
  // Whether it was changed: only then is Python asked, which may have to be loaded. Set while the page changes the text.
  let edited = false;
  // The first error in words, for who can't hover over it.
  const said = element("p", { className: "code-problem", hidden: true, ariaLive: "polite" });
  let filling = false;
  const view = new EditorView({
    parent,
    doc: text,
    extensions: [
      mirror.keymap.of([{ key: "Escape", run: letTabLeave }, ...mirror.closeBracketsKeymap, ...mirror.completionKeymap]),
      mirror.keymap.of([mirror.indentWithTab, ...mirror.defaultKeymap, ...mirror.historyKeymap]),
      mirror.history(),
      mirror.drawSelection(),
      mirror.bracketMatching(),
      mirror.closeBrackets(),
      mirror.indentUnit.of("    "),
      mirror.syntaxHighlighting(colours),
      mirror.lineNumbers({ formatNumber: numbers(before) }),
      isPhone ? EditorView.lineWrapping : [],
      EditorView.contentAttributes.of({ "aria-label": label, tabindex: "0", spellcheck: "false", autocapitalize: "off", autocorrect: "off" }),
      EditorView.updateListener.of((update) => {
        edited ||= update.docChanged;
        if (update.docChanged && !filling) onchange(update.state.doc.toString());
      }),
      EditorView.domEventHandlers({ beforeinput: typeOver }),
      // The page's header covers what is scrolled to its top (px).
      EditorView.scrollMargins.of(() => ({ top: 64 })),
      look,
      ...(language === "python" ? forPython(before, () => edited, said) : []),
    ],
  });
  parent.append(said);
  return {
    focus(point) {
      view.focus();
      const at = point && view.posAtCoords(point, false);
      if (at !== undefined && at !== null) view.dispatch({ selection: { anchor: at } });
    },
    fill(now) {
      filling = true;
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: now } });
      filling = false;
    },
  };
}

// After Escape, Tab leaves the editor, for as long as nothing else is pressed.
function letTabLeave(view) {
  view.setTabFocusMode(true);
  const stay = (event) => {
    if (["Escape", "Tab", "Shift"].includes(event.key)) return;
    view.setTabFocusMode(false);
    view.contentDOM.removeEventListener("keydown", stay, true);
  };
  view.contentDOM.addEventListener("keydown", stay, true);
  return false;
}

// Where browsers type over several lines themselves, they write styles, which the page's policy forbids.
function typeOver({ inputType, data }, view) {
  const { from, to } = view.state.selection.main;
  if (inputType !== "insertText" || !data || to <= view.state.doc.lineAt(from).to) return false;
  const insert = () => view.state.update(view.state.replaceSelection(data), { userEvent: "input.type", scrollIntoView: true });
  if (!view.state.facet(EditorView.inputHandler).some((handle) => handle(view, from, to, data, insert))) view.dispatch(insert());
  return true;
}

// Lines are numbered as in the program's errors.
function numbers(before) {
  const first = before.split("\n").length - 1;
  return (line) => String(first + line);
}

function forPython(before, edited, said) {
  const { language, support } = mirror.python();
  const complete = async (context) => {
    if (!edited()) return null;
    const word = context.matchBefore(/\w*/);
    const options = await completions(before + context.state.doc.toString(), before.length + context.pos);
    return options?.length ? { from: word.from, options, validFor: /^\w*$/ } : null;
  };
  const underline = async (view) => {
    const { doc } = view.state;
    if (!edited()) return [];
    const found = (await problems(before + doc.toString())) ?? [];
    said.hidden = found.length === 0;
    said.textContent = found.length ? `Line ${found[0].line}: ${found[0].text}` : "";
    return found.map((problem) => marked(doc, before, problem)).filter(Boolean);
  };
  return [
    language,
    support,
    language.data.of({ autocomplete: complete }),
    // Its own keys would take Escape before the editor's see it.
    mirror.autocompletion({ defaultKeymap: false }),
    mirror.indentOnInput(),
    mirror.linter(underline, { delay: UNDERLINE_MS }),
  ];
}

// Return a problem as CodeMirror shows it: its part of the line, without the indentation.
function marked(doc, before, { line, from, to, text }) {
  const number = line - before.split("\n").length + 1;
  if (number < 1 || number > doc.lines) return null;
  const there = doc.line(number);
  const indentation = there.text.length - there.text.trimStart().length;
  const start = there.from + Math.min(from ?? indentation, Math.max(there.length - 1, 0));
  const end = Math.max(start + 1, there.from + Math.min(to ?? there.length, there.length));
  return { from: start, to: Math.min(end, doc.length), severity: "error", message: text };
}
