// What Python says of code that is edited: its errors, and the names that can follow. A process that waits for its
// program is asked; until there is one, nothing is said.
import { prepare } from "./download.js";

// Ask the process that waits, or null if none can be there.
async function ask(op, given) {
  const process = await prepare();
  try {
    await process?.ready;
    return process && (await process.call(op, given));
  } catch {
    return null; // Without a network or memory, the code can be edited all the same.
  }
}

// Return a program's errors, each with its line from 1, maybe its columns from 0, and its text.
export const problems = (source) => ask("advice.problems", { source });

// Return the names that can be at this place in a program, with what they are.
export const completions = (source, at) => ask("advice.completions", { source, at });
