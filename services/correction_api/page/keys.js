// Keys for the robot in focus. They rest while somebody types, and can be turned off.
import { say } from "./say.js";
import { next, state } from "./store.js";

export function listen() {
  document.addEventListener("keydown", (event) => {
    const robot = state.robots[state.focused];
    if (!robot || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
    const typing = event.target.matches("input:not([type=checkbox]), select, textarea");
    if (event.key === "Escape" && typing) event.target.blur();
    else if (state.keys && !typing && press(robot, event.key)) event.preventDefault();
  });
}

function press(robot, key) {
  const text = /^[1-9]$/.test(key) && state.slots[robot.robot]?.[Number(key) - 1];
  if (text) say(robot.robot, { kind: "override", text });
  else if (key === "y" && robot.decision) say(robot.robot, { kind: "approve" });
  else if (key === "r" && robot.by === "person") say(robot.robot, { kind: "release" });
  else if (key === "Escape") say(robot.robot, { kind: "pause" });
  else if (key === "n") next();
  else if (key === "/") words(robot.robot).focus();
  else return false;
  return true;
}

const words = (robot) => document.querySelector(`[data-robot="${robot}"] input[name="words"]`);
