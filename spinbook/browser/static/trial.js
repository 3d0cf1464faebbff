// "Try it" on an exercise's page: the node in the editor runs among what surrounds it in the exercise, in real time, with
// a picture. Nothing is judged.
import { bar } from "./bar.js";
import { button, element } from "./elements.js";
import { fill } from "./picture.js";
import { take } from "./processes.js";

const LINES = 500;

let playing = [];

// End what plays.
export const stopTrial = () => Promise.all(playing.map((process) => process.stop()));

// Play `scenario` of an exercise ("" for the first) around a program; `say` gets the state. Resolves when it is over.
export async function tryOut({ exercise, file, source, scenario, place, say }) {
  await stopTrial();
  bar();
  const figure = element("figure");
  globalThis.sideways.observe(figure);
  const log = (label) => element("pre", { tabIndex: 0, role: "log", ariaLabel: label });
  const around = log("What surrounds your node");
  const own = log(`What ${file} prints`);
  const heads = [around, own].map((pre) => element("p", { className: "try-head", textContent: pre.ariaLabel }));
  place.replaceChildren(figure, heads[0], around, heads[1], own);
  // Once something else is shown, this one has nothing to say any more.
  const tell = (text) => figure.isConnected && say(text);
  const surroundings = take("surroundings", {
    progress: (part) => tell(`Loading ${part} …`),
    output: (text) => print(around, text),
    picture: (text) => draw(figure, JSON.parse(text)),
  });
  playing = [surroundings];
  try {
    await surroundings.ready;
    const plan = await surroundings.call("trial.plan", { name: exercise, chosen: scenario });
    if (!plan) return tell("Stopped.");
    if (plan.problem) return tell(plan.problem);
    const node = take(file.replace(/\.py$/, ""), { output: (text) => print(own, text) });
    playing.push(node);
    const ended = node.program(source, file, plan.args.slice(1));
    surroundings.work("surroundings");
    tell(`Scenario ${plan.scenario} runs in real time …`);
    place.append(element("p", { className: "try-scenarios" }, "Play ", ...plan.scenarios.flatMap((name) => choice(name, place))));
    ended.then((status) => status && print(own, `— ended with ${status} —`));
    await surroundings.call("trial.play_around", { name: exercise, chosen: plan.scenario }).finally(() => surroundings.work(""));
    await node.stop();
    tell(`Scenario ${plan.scenario} is over. Nothing was judged: Check does that.`);
  } catch (error) {
    if (figure.isConnected) throw error;
  } finally {
    surroundings.end();
  }
}

function choice(name, place) {
  return [button(name, `Play the scenario ${name}`, () => place.dispatchEvent(new CustomEvent("play", { detail: name }))), " "];
}

function print(pre, text) {
  pre.append(element("span", { textContent: `${text}\n` }));
  if (pre.childElementCount > LINES) pre.firstChild.remove();
  pre.scrollTop = pre.scrollHeight;
}

// Drawn by Spinbook's own code, which escapes names. Each kind of picture has rules of its own.
function draw(figure, { svg, robot, words = robot.words, kind }) {
  figure.className = kind;
  if (robot) {
    figure.replaceChildren();
    globalThis.moveRobot(figure, robot);
  } else fill(figure, svg, `.${kind}`);
  figure.dataset.words = words;
}
