// The lines of a page's magics: the same words, options and messages as in a notebook (spinbook/kernel/magics.py).

// What may follow each name, as the usage that argparse prints.
export const USAGES = {
  nodes: "[-h]",
  stop: "[-h] [--all] [names ...]",
  log: "[-h] [--all] [--until UNTIL] [--seconds SECONDS] name",
  plot: "[-h] [--seconds SECONDS] [--title TITLE] TOPIC/FIELD[i] [TOPIC/FIELD[i] ...]",
  timeline: "[-h] [--record NAME [NAME ...]] [--title TITLE]",
  turtle: "[-h]",
  robot: "[-h] [--seconds SECONDS] [source]",
  graph: "[-h] [--seconds SECONDS]",
};
const OPTION = /\[(--\w+)( [A-Z]+( \[[A-Z]+ \.\.\.\])?)?\] ?/g;
const QUOTED = /"([^"]*)"|'([^']*)'/g;
const COMMENT = /("[^"]*"|'[^']*')|(?<!\S)#.*/g;
const WORD = /(?:"[^"]*"|'[^']*'|[^\s"'])+/g;

// A line that a magic does not understand.
export class UsageError extends Error {}

// The words of a line, quoted as in a shell and without a `# comment`.
export function wordsOf(typed) {
  const line = typed.replace(COMMENT, "$1");
  if (/["']/.test(line.replace(QUOTED, ""))) throw new UsageError(`A quotation mark is missing in: ${line}`);
  return (line.match(WORD) ?? []).map((word) => word.replace(QUOTED, "$1$2"));
}

// Return the options of a magic by their names, and the other words as `words`. Throws what is wrong, in words.
export function read(name, line) {
  const usage = USAGES[name];
  const refuse = (why) => {
    throw new UsageError(`${why ? `${why}\n` : ""}usage: %${name} ${usage}`);
  };
  const kinds = {};
  for (const [, option, value, many] of usage.matchAll(OPTION)) kinds[option] = many ? "many" : value ? "value" : "flag";
  const others = usage.replace(OPTION, "").replace("[-h]", "").trim();
  const most = others.includes("...") ? Infinity : others ? 1 : 0;
  const options = { words: [] };
  const unknown = [];
  const left = wordsOf(line).flatMap((word) => (/^--\w+=/.test(word) ? [word.split("=", 1)[0], word.slice(word.indexOf("=") + 1)] : [word]));
  while (left.length) {
    const word = left.shift();
    if (word === "-h" || word === "--help") refuse("");
    else if (!word.startsWith("--")) (options.words.length < most ? options.words : unknown).push(word);
    else if (!kinds[word]) unknown.push(word);
    else options[word.slice(2)] = valueOf(word, kinds[word], left, refuse);
  }
  if (others && !others.startsWith("[") && !options.words.length) refuse(`the following arguments are required: ${others.split(" ")[0]}`);
  if (unknown.length) refuse(`unrecognized arguments: ${unknown.join(" ")}`);
  return options;
}

function valueOf(option, kind, left, refuse) {
  if (kind === "flag") return true;
  const end = left.findIndex((word) => word.startsWith("--"));
  const values = left.splice(0, kind === "many" ? (end < 0 ? left.length : end) : end === 0 ? 0 : 1);
  if (!values.length) refuse(`argument ${option}: expected ${kind === "many" ? "at least one argument" : "one argument"}`);
  if (kind === "many") return values;
  if (option !== "--seconds") return values[0];
  if (!values[0] || Number.isNaN(Number(values[0]))) refuse(`argument ${option}: invalid float value: '${values[0]}'`);
  return Number(values[0]);
}
