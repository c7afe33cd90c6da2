// What the page knows; every change asks for one render at the next frame.
import { get } from "./api.js";

const HISTORY = 20;
const SLOTS = 9;
const AUTHOR = "hld-author";

export const state = {
  linked: false,
  ready: false,
  locked: false,
  keys: true,
  focused: null,
  name: localStorage.getItem(AUTHOR) ?? "person", // as it was typed; see `author`
  robots: {},
  learner: null,
  tally: [],
  help: { asking: [], suppressed: 0 }, // robots in doubt, the most urgent first
  corrections: {}, // by robot, the newest first
  said: {}, // by robot: the last thing that was said here, and what became of it
  slots: {}, // by robot: which phrase stands on which key
};

let changed = () => {};
let waiting = false;

export const onChange = (render) => (changed = render);

export function touch() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    changed();
  });
}

/** Kept at every key stroke: the page is drawn anew several times a second. */
export function setName(name) {
  state.name = name;
  localStorage.setItem(AUTHOR, name);
  touch();
}

/** Under which id this person's corrections go. */
export const author = () =>
  state.name.toLowerCase().replace(/[^a-z0-9-]+/g, "-").slice(0, 64) || "person";

/** The robot's call for help, if one is open. */
export const callOf = (robot) => state.help.asking.find((call) => call.robot === robot);

/** Focus the next robot in doubt; from one that isn't, the most urgent. */
export function next() {
  const robots = state.help.asking.map(({ robot }) => robot);
  if (!robots.length) return;
  state.focused = robots[(robots.indexOf(state.focused) + 1) % robots.length];
  document.querySelector(`[data-robot="${state.focused}"]`)?.scrollIntoView({ block: "nearest" });
  touch();
}

/** Take in a message of the WebSocket. */
export function hear(message) {
  if (message.type === "robot") hearRobot(message.robot);
  if (message.type === "learner") state.learner = message.learner;
  if (message.type === "help") state.help = message.help;
  if (message.type === "correction") hearCorrection(message.correction);
  if (message.type === "episode") loadTally();
  touch();
}

function hearRobot(robot) {
  state.robots[robot.robot] = robot;
  state.focused ??= robot.robot;
  if (robot.decision) arrange(robot.robot, robot.decision.proposed);
}

export function hearCorrection(view) {
  const { robot, id } = view.correction;
  const others = (state.corrections[robot] ?? []).filter((other) => other.correction.id !== id);
  state.corrections[robot] = [view, ...others]
    .sort((one, other) => other.sequence - one.sequence)
    .slice(0, HISTORY);
  if (state.said[robot]?.id === id) {
    state.said[robot] = { ...state.said[robot], status: view.status, view };
  }
}

/**
 * Give each phrase a place that it keeps: scores change several times a second, and a button must
 * not move away under the finger. The best three are always there.
 */
export function arrange(robot, proposed) {
  const scores = new Map(proposed.map(({ goal, score }) => [goal.text, score]));
  const slots = (state.slots[robot] ?? []).filter((text) => scores.has(text));
  for (const [rank, { goal }] of proposed.entries()) {
    if (slots.includes(goal.text)) continue;
    if (slots.length < SLOTS) slots.push(goal.text);
    else if (rank < 3) slots[worst(slots, scores)] = goal.text;
  }
  state.slots[robot] = slots;
}

const worst = (slots, scores) =>
  slots.reduce((low, text, at) => (scores.get(text) < scores.get(slots[low]) ? at : low), 0);

export async function loadTally() {
  state.tally = (await get("episodes?limit=1")).tally;
  touch();
}

/** What was said before this page was opened. */
export async function loadHistory() {
  const { corrections } = await get("corrections?limit=100");
  for (const view of corrections.reverse()) hearCorrection(view);
  touch();
}
