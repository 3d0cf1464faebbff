// Code that can be edited in place. CodeMirror is loaded when a reader first edits something; without it, a plain text
// area does.
import { addressOf } from "./address.js";
import { element } from "./elements.js";

// Make the code in `place`, a <pre>, editable: by a click, by Enter, and at once if its text is another one than the
// page's. `language` is "python" or "". `before` is what precedes the code in its program.
export function createEditor(place, name, language = "", before = "") {
  // A field of its own: the page gives the <pre> another role if it scrolls.
  const still = element(
    "span",
    { className: "editor", tabIndex: 0, role: "textbox", ariaMultiLine: "true", ariaReadOnly: "true", ariaLabel: `Code of ${name}. Enter edits it.` },
    ...place.childNodes,
  );
  place.append(still);
  const written = still.textContent;
  const label = `Code of ${name}. Escape, then Tab, leaves it.`;
  let text = written;
  let opening = null;
  let view = null;
  const heard = (now) => {
    // What the Copy button copies.
    still.textContent = text = now;
    field.onchange();
  };
  // A text ends in a line break, after which the editor would show an empty line.
  const shown = () => text.replace(/\n$/, "");
  const end = written.endsWith("\n") ? "\n" : "";

  async function show() {
    const { codeView } = await import(addressOf("code_view.js")).catch(() => ({ codeView: plainView }));
    const frame = element("div", { className: "code-editor" });
    frame.addEventListener("keydown", run, true);
    place.after(frame);
    view = codeView({ parent: frame, text: shown(), label, language, before, onchange: (now) => heard(now + end) });
    place.hidden = true;
  }

  function run(event) {
    if (event.key !== "Enter" || !(event.shiftKey || event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    event.stopPropagation();
    field.onrun();
  }

  const field = {
    written,
    onchange: () => {},
    // Shift+Enter was pressed.
    onrun: () => {},
    get text() {
      return text;
    },
    // Show the code in an editor; its caret is where the reader has clicked.
    async open(point) {
      opening ??= show();
      await opening;
      view.focus(point);
    },
    // Show another text; `onchange` is not called.
    fill(now) {
      if (now === text) return;
      still.textContent = text = now;
      if (view) view.fill(shown());
      else opening ??= show();
    },
  };
  still.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.shiftKey) return run(event);
    event.preventDefault();
    field.open();
  });
  return field;
}

// The editor if CodeMirror can't be loaded.
function plainView({ parent, text, label, onchange }) {
  const area = element("textarea", { value: text, spellcheck: false, rows: text.split("\n").length + 1, ariaLabel: label });
  area.addEventListener("input", () => onchange(area.value));
  parent.append(area);
  return { focus: () => area.focus(), fill: (now) => (area.value = now) };
}
