// What readers have written into cells, with earlier versions: kept in this browser, and in step between its tabs.
const PREFIX = "code:";
const MOST_VERSIONS = 10;
const FULL =
  "Your changes are not saved: this browser's storage for this site is full. Copy your code before you close the page.";
const FORBIDDEN =
  "Your changes are not saved: this browser does not let the page store anything. Copy your code before you close the page.";

const NONE = { text: null, versions: [] };

const read = (text) => {
  try {
    const record = JSON.parse(text);
    if (typeof record.original === "string") return { versions: [], ...record };
  } catch {
    // Drafts of earlier versions of this site are plain text.
  }
  return { text, versions: [] };
};

// Return what a look into the browser's storage gives, otherwise `none`: it may be forbidden.
function stored(look, none) {
  try {
    return look();
  } catch {
    return none;
  }
}

// Return every draft of a page, by its key.
const draftsOf = (page) =>
  stored(() => {
    const keys = Object.keys(localStorage).filter((key) => key.startsWith(PREFIX + page));
    return new Map(keys.map((key) => [key.slice(PREFIX.length), read(localStorage.getItem(key))]));
  }, new Map());

export const forget = (key) => stored(() => localStorage.removeItem(PREFIX + key));

// Return why it could not be stored; "" if it could. If there is little room, earlier versions are given up first.
function store(key, record) {
  for (const versions of [record.versions, record.versions.slice(0, 1), []]) {
    try {
      localStorage.setItem(PREFIX + key, JSON.stringify({ ...record, versions }));
      return "";
    } catch (error) {
      if (error.name !== "QuotaExceededError") return FORBIDDEN;
    }
  }
  return FULL;
}

// Give each draft to the cell whose code it was made from, which may have moved on the page. Return the drafts whose
// cell is gone. A cell has a `key` and the code `written` in the course.
export function settle(page, cells) {
  const drafts = draftsOf(page);
  const home = new Map(cells.map((cell) => [cell.key, cell]));
  const fits = (key) => drafts.get(key)?.original === home.get(key)?.written;
  for (const [key, draft] of [...drafts].filter(([key, draft]) => draft.original !== undefined && !fits(key))) {
    const cell = cells.find((each) => each.written === draft.original && !(drafts.has(each.key) && fits(each.key)));
    if (!cell) continue;
    const displaced = drafts.get(cell.key);
    if (displaced) drafts.set(key, displaced);
    else drafts.delete(key);
    drafts.set(cell.key, draft);
    for (const each of [key, cell.key]) drafts.has(each) ? store(each, drafts.get(each)) : forget(each);
  }
  return [...drafts].filter(([key, { text }]) => !home.has(key) && typeof text === "string");
}

export class Draft {
  // `written` is the course's code. `hear` gets what to say when another tab has changed the draft.
  constructor(key, written, hear) {
    this.key = key;
    this.written = written;
    this.hear = hear;
    this.#take(this.#stored() ?? NONE);
    addEventListener("storage", ({ key: changed, newValue }) => {
      if (changed === PREFIX + key) this.#follow(newValue === null ? NONE : read(newValue));
    });
    addEventListener("beforeunload", (event) => this.trouble && this.text !== null && event.preventDefault());
  }

  #stored() {
    const text = stored(() => localStorage.getItem(PREFIX + this.key), null);
    return text === null ? null : read(text);
  }

  #take({ text, original = this.written, versions }) {
    this.text = text === original || text === this.written ? null : text;
    this.original = this.text === null ? this.written : original;
    this.versions = versions;
    this.trouble = "";
  }

  // The code to show and to run.
  get current() {
    return this.text ?? this.written;
  }

  // Whether the course's code is another one than when the reader began to edit it.
  get isOutdated() {
    return this.original !== this.written;
  }

  keep(text) {
    this.#merge();
    this.text = text === this.written ? null : text;
    this.#save();
  }

  // Add a version to the history: `why` says when it was current.
  note(why, text = this.current) {
    if (text === this.written || this.versions[0]?.text === text) return;
    this.versions = [{ text, why, time: Date.now() }, ...this.versions.filter((each) => each.text !== text)].slice(0, MOST_VERSIONS);
    this.#save();
  }

  // Go on with the reader's code, on top of the course's new one; the old one stays in the history.
  accept() {
    const { original } = this;
    this.original = this.written;
    this.note("the course's earlier code", original);
    this.#save();
  }

  // Another tab may have stored something that this one did not hear of: keep it, too.
  #merge() {
    const stored = this.#stored();
    if (!stored || stored.text === this.text || stored.text === null) return;
    this.note("from another tab", stored.text);
    this.hear("Another tab had changed this code, too: its version is under Changes.");
  }

  #follow(record) {
    if (record.text === this.text) return void (this.versions = record.versions);
    this.#take(record);
    this.hear("Changed in another tab.", true);
  }

  #save() {
    if (this.text === null && this.versions.length === 0) forget(this.key);
    else this.trouble = store(this.key, { text: this.text, original: this.original, versions: this.versions });
  }
}
