// What readers see of their changes to a cell: the mark "edited", the lines they changed, earlier versions, and Undo.
import { shownDifference } from "./difference.js";
import { Draft } from "./drafts.js";
import { button, element } from "./elements.js";

const OUTDATED = "The course has a new version of this code. Yours is still shown and runs; both are kept.";
const timeOf = (time) => new Date(time).toLocaleString([], { dateStyle: "medium", timeStyle: "medium" });

export class Edits {
  // `editor` holds the code called `name`; `buttons` gets the buttons, and `after` is followed by notes and the panel.
  constructor(editor, key, name, buttons, after) {
    this.editor = editor;
    this.name = name;
    this.draft = new Draft(key, editor.written, (text, changed) => this.#heard(text, changed));
    this.badge = element("span", { className: "edited", textContent: "edited" });
    this.reset = button("Reset", `Reset ${name}`, () => this.restore());
    this.changes = button("Changes", `Changes in ${name}`, () => this.#toggle());
    this.changes.ariaExpanded = "false";
    this.notes = element("div", { className: "edit-notes", ariaLive: "polite" });
    this.panel = element("div", { className: "changes", hidden: true });
    buttons.prepend(this.badge, this.changes, this.reset);
    after.after(this.notes, this.panel);
    editor.fill(this.draft.current);
    editor.onchange = () => this.#changed();
    if (this.draft.isOutdated) this.#warn();
    this.#show();
  }

  // Keep the current code as a version: it runs, or is about to be replaced.
  note(why) {
    this.stays = false;
    this.draft.note(why);
    this.#show();
  }

  restore() {
    this.#replace(this.editor.written, "before Reset", "This is the course's code again.");
    this.onrestore?.();
  }

  // Replace the code by that of a file.
  take(text, said) {
    this.#replace(text, "before Upload", said);
  }

  #replace(text, why, said) {
    const before = this.editor.text;
    this.draft.note(why, before);
    this.#put(text);
    const undo = button("Undo", `Undo the change of ${this.name}`, () => {
      this.draft.note("before Undo");
      this.#put(before);
      this.#say("Undone.");
    });
    if (before === text) this.#say(said);
    else this.#say(`${said} `, undo);
  }

  #put(text) {
    this.editor.fill(text);
    this.#changed();
  }

  #changed() {
    if (!this.stays) this.notes.replaceChildren();
    this.draft.keep(this.editor.text);
    this.#show();
    this.onchange?.();
  }

  #heard(text, changed) {
    if (changed) this.editor.fill(this.draft.current);
    this.#say(text);
    this.stays = true; // until it is run, whatever is typed meanwhile
    this.#show();
  }

  #say(...parts) {
    this.notes.replaceChildren(element("p", {}, ...parts));
    if (this.draft.trouble) this.notes.append(element("p", { className: "edit-trouble", textContent: this.draft.trouble }));
  }

  #warn() {
    const keep = button("Keep mine", `Keep your ${this.name}`, () => (this.draft.accept(), this.#say("Kept."), this.#show()));
    const renew = button("Use the new one", `Use the course's new ${this.name}`, () => {
      this.draft.accept();
      this.restore();
    });
    this.#say(`${OUTDATED} `, keep, renew);
  }

  #show() {
    const changed = this.editor.text !== this.editor.written;
    this.badge.hidden = this.reset.hidden = !changed;
    this.changes.hidden = !changed && this.draft.versions.length === 0;
    if (this.draft.trouble && changed && !this.notes.querySelector(".edit-trouble")) {
      this.notes.append(element("p", { className: "edit-trouble", textContent: this.draft.trouble }));
    }
    if (this.changes.hidden) this.#open(false);
    else if (!this.panel.hidden) this.#fill();
  }

  #toggle() {
    this.#open(this.panel.hidden);
    if (!this.panel.hidden) this.#fill();
  }

  #open(yes) {
    this.panel.hidden = !yes;
    this.changes.ariaExpanded = String(yes);
  }

  // Show what differs from a version, which the reader chooses.
  #fill() {
    const others = [{ label: "the course's code", text: this.editor.written }];
    if (this.draft.isOutdated) others.push({ label: "the course's earlier code", text: this.draft.original });
    others.push(...this.draft.versions.map(({ text, why, time }) => ({ label: `${timeOf(time)}, ${why}`, text })));
    const choice = element("select", {}, ...others.map(({ label }) => element("option", { textContent: label })));
    const lines = element("pre", { className: "diff", tabIndex: 0, role: "group", ariaLabel: "Lines that differ" });
    const show = () => lines.replaceChildren(...shownDifference(others[choice.selectedIndex].text, this.editor.text));
    choice.addEventListener("change", show);
    const use = button("Use that version", `Use that version of ${this.name}`, () => {
      this.#replace(others[choice.selectedIndex].text, "before an earlier version", "This is the version that you chose.");
    });
    const words = element("label", {}, "Your code compared with ", choice);
    this.panel.replaceChildren(element("div", { className: "changes-head" }, words, use), lines);
    show();
  }
}
