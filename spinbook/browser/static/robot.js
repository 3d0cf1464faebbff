// `%robot`: a robot that moves as the page's nodes say. A process of its own listens, and the site's script draws.
import { element } from "./elements.js";
import { take } from "./processes.js";

// Show a robot in a cell. Resolves when it is there.
export function robot(cell, source) {
  return new Promise((shown) => {
    const place = element("figure", { className: "robot live-robot" });
    let view = null;
    let why = "No /robot_description has arrived. Name a package, such as %robot humanoid_description";
    const heard = async ({ robot, positions, problem }) => {
      if (!place.isConnected) return process.end();
      if (problem) why = problem;
      if (robot) {
        place.replaceChildren();
        view = await globalThis.moveRobot(place, robot);
        if (!view) place.textContent = robot.words;
      }
      if (positions) view?.move(positions);
      if (robot) shown();
    };
    const process = take("robot", {
      picture: (text) => heard(JSON.parse(text)),
      output: (text, stream) => stream === "stderr" && cell.print(text, stream),
    });
    cell.shown?.append(place);
    cell.say("Looking for the robot …", "running");
    process.ready
      .then(() => process.call("robot", { source }))
      .catch((error) => (why = error.message))
      .finally(() => {
        process.end();
        if (view) view.say("Nobody publishes joint positions. Run this cell again to see the robot move.");
        else if (place.isConnected) cell.fail(why);
        shown();
      });
  });
}
