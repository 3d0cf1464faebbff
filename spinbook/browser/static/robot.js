// `%robot`: a robot that moves as the page's nodes say. A terminal's process records, and the site's script draws.
import { element } from "./elements.js";

// Show a robot in a cell for as many seconds as a notebook records, from the first position on.
export async function robot(cell, process, { words: [source = ""], seconds }) {
  const place = element("figure", { className: "robot live-robot" });
  let view = null;
  process.hears.picture = async (text) => {
    const { robot, positions } = JSON.parse(text);
    if (robot) {
      place.replaceChildren();
      view = await globalThis.moveRobot(place, robot);
      if (!view) place.textContent = robot.words;
    }
    if (positions) view?.move(positions);
  };
  cell.shown?.append(place);
  cell.say(`Recording for ${seconds} s …`, "running");
  const { problem, moves } = (await process.call("robot.show", { source, seconds })) ?? {};
  if (!view) place.remove();
  if (problem) cell.fail(problem);
  else if (moves === false) view?.say("Nobody publishes joint positions. Run this cell again to see the robot move.");
}
