// Code that can be edited in place.
import { colours } from "./highlight.js";

const STEP = "    ";

// Make the code in `place`, a <pre>, editable. Tab indents; Escape, then Tab, leaves it. Python code is highlighted.
export function createEditor(place, name, language = "") {
  // A field of its own: the page gives the <pre> another role if it scrolls.
  const code = document.createElement("span");
  code.className = "editor";
  code.append(...place.childNodes);
  place.append(code);
  const original = code.innerHTML;
  const written = code.textContent;
  const colour = language === "python" ? colours(code) : () => {};
  let leaving = false;
  const field = {
    written,
    onchange: () => {},
    focus: () => code.focus(),
    get text() {
      return code.textContent;
    },
    // Show another text; `onchange` is not called.
    fill(text) {
      if (language === "python" || text !== written) code.textContent = text;
      else code.innerHTML = original;
      colour();
    },
  };
  code.contentEditable = "plaintext-only";
  code.tabIndex = 0; // Editable elements can always be focused, but accessibility checkers look for a tabindex.
  code.spellcheck = false;
  code.setAttribute("role", "textbox");
  code.setAttribute("aria-multiline", "true");
  code.setAttribute("aria-label", `Code of ${name}. Escape, then Tab, leaves it.`);
  code.addEventListener("input", () => {
    colour();
    field.onchange();
  });
  code.addEventListener("keydown", (event) => {
    if (event.key === "Escape") leaving = true;
    else if (event.key === "Tab" && !event.shiftKey && !leaving) {
      event.preventDefault();
      document.execCommand("insertText", false, STEP);
    } else if (event.key !== "Tab" && event.key !== "Shift") leaving = false;
  });
  return field;
}
