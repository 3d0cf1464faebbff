// Highlights Python while it is edited, with the CSS Custom Highlight API: the text itself stays as it is typed.
// The classes are those of the site's own highlighting: word, text, number, note, name.

const WORDS = new Set(
  ("False None True and as assert async await break case class continue def del elif else except finally for from global if " +
    "import in is lambda match nonlocal not or pass raise return try while with yield").split(" "),
);
const BUILTINS = new Set(
  ("abs all any bool bytes callable chr cls dict dir divmod enumerate filter float format getattr hasattr hash int " +
    "isinstance issubclass iter len list map max min next object open print property range repr reversed round self set " +
    "setattr sorted staticmethod classmethod str sum super tuple type zip __name__ __file__ __init__ __main__ __call__").split(" "),
);
const SOFT = new Set(["match", "case"]);
const TOKEN =
  /([rbfu]{0,2}(?:"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:\\[^]|[^"\\\n])*"?|'(?:\\[^]|[^'\\\n])*'?))|(#[^\n]*)|(\b\d[\w.]*)|(@[\w.]+)|([A-Za-z_]\w*)/gi;
const can = typeof Highlight === "function" && Boolean(CSS.highlights);
const registry = new Map();

function registered(kind) {
  if (!registry.has(kind)) {
    registry.set(kind, new Highlight());
    CSS.highlights.set(`code-${kind}`, registry.get(kind));
  }
  return registry.get(kind);
}

// Return the kind, the start and the end of each coloured piece.
export function tokens(source) {
  const found = [];
  let before = "";
  let module = false;
  let isFrom = false;
  for (const match of source.matchAll(TOKEN)) {
    const [whole, text, note, number, decorator, word] = match;
    const at = match.index;
    if (text) found.push(...pieces(whole, at));
    else if (note) found.push(["note", at, at + whole.length]);
    else if (number) found.push(["number", at, at + whole.length]);
    else if (source[at - 1] === "." && found.at(-1)?.[2] === at - 1 && module) found.at(-1)[2] = at + whole.length;
    else if (decorator || ["def", "class", "from"].includes(before) || (before === "import" && !isFrom)) {
      found.push(["name", at, at + whole.length]);
      module = before === "from" || before === "import";
    }
    else if (WORDS.has(word) && !(SOFT.has(word) && !/^\s+[\w"'([{-].*:\s*(#.*)?$/m.test(line(source, at + whole.length)))) {
      found.push(["word", at, at + whole.length]);
    } else if (BUILTINS.has(word) && source[at - 1] !== ".") found.push(["name", at, at + whole.length]);
    else if (/^__\w+__$/.test(word)) found.push(["name", at, at + whole.length]);
    before = word ?? "";
    if (word === "from" || word === "import") [isFrom, module] = [word === "from" || (isFrom && !newLine(source, at)), false];
  }
  return found;
}

const newLine = (source, at) => at === 0 || source[at - 1] === "\n";
const line = (source, at) => source.slice(at, (source.indexOf("\n", at) + 1 || source.length + 1) - 1);

// Return the pieces of a string. The expressions in an f-string are not coloured.
function pieces(text, at) {
  if (!/^[rb]?f/i.test(text)) return [["text", at, at + text.length]];
  const found = [];
  let from = 0;
  for (const inner of text.matchAll(/\{[^{}\n]*\}/g)) {
    found.push(["text", at + from, at + inner.index + 1]);
    from = inner.index + inner[0].length - 1;
  }
  return [...found, ["text", at + from, at + text.length]];
}

// Return a function that colours the text in `place`; call it after each change.
export function colours(place) {
  if (!can) return () => {};
  let mine = [];
  return () => {
    for (const [kind, range] of mine) registered(kind).delete(range);
    mine = [];
    const walker = document.createTreeWalker(place, NodeFilter.SHOW_TEXT);
    const nodes = [];
    for (let length = 0; walker.nextNode(); ) nodes.push([walker.currentNode, length, (length += walker.currentNode.length)]);
    for (const [kind, from, to] of tokens(place.textContent)) {
      const begin = nodes.find(([, , end]) => from < end);
      const finish = nodes.find(([, , end]) => to <= end);
      if (!begin || !finish) continue;
      const range = new StaticRange({
        startContainer: begin[0],
        startOffset: from - begin[1],
        endContainer: finish[0],
        endOffset: to - finish[1],
      });
      registered(kind).add(range);
      mine.push([kind, range]);
    }
  };
}
