// What Python says of code that is edited: its errors, and the names that can follow. A process that waits for its
// program is asked; until there is one, nothing is said.
import { download } from "./download.js";
import { hindrance } from "./elements.js";
import { prepared } from "./processes.js";

let loading = null;

// Ask the process that waits, or null if none can be there.
async function ask(op, given) {
  if (hindrance()) return null;
  await (loading ??= download(() => {}));
  const process = prepared();
  try {
    await process.ready;
    return await process.call(op, given);
  } catch {
    return null; // Without a network or memory, the code can be edited all the same.
  }
}

// Return a program's errors, each with its line from 1, maybe its columns from 0, and its text.
export const problems = (source) => ask("advice.problems", { source });

// Return the names that can be at this place in a program, with what they are.
export const completions = (source, at) => ask("advice.completions", { source, at });
