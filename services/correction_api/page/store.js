// What the page knows; every change asks for one render at the next frame.
import { get } from "./api.js";
import { arrange } from "./places.js";
import { inquire, refused } from "./scene.js";
import { idOf } from "./words.js";

const HISTORY = 60;
const AUTHOR = "hld-author";
const FOCUSED = "hld-focused"; // kept for this tab, so that the stop is for the same robot after a reload
const COMES_BACK_MS = 2000;

export const state = {
  linked: false,
  silent: 0, // for so many seconds nothing was heard of the service, if that is too long
  ready: false,
  locked: false,
  keys: true, // whether single keys act
  asking: false, // whether the list of keys is open
  focused: null,
  name: localStorage.getItem(AUTHOR) ?? "person", // as it was typed; see `author`
  person: null, // whose token this page has, where tokens have names
  introduced: null, // the name under which others see this page
  here: [], // who else has a page open: name and robots in focus
  robots: {},
  learner: null,
  tally: [],
  help: { asking: [], suppressed: 0 }, // robots in doubt, the most urgent first
  corrections: {}, // by robot, the newest first
  sending: {}, // by id: what was said here and is not in the log yet, or was never taken
  places: {}, // by robot: which phrase stands on which key, see `places.js`
  line: { mark: "", text: "" }, // the one line that is read out
  aside: "", // what it reads out besides, which stands elsewhere on the page (`line.js`)
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

/** Say something in the line that is read out. mark: good, bad, wait or nothing. */
export function tell(text, mark = "") {
  state.line = { mark, text };
  touch();
}

/** Kept at every key stroke: the page is drawn anew several times a second. */
export function setName(name) {
  state.name = name;
  localStorage.setItem(AUTHOR, name);
  touch();
}

/** Under which id this person's corrections go. */
export const author = () => idOf(state.name);

export const names = () => Object.keys(state.robots).sort(byNumber);
const byNumber = new Intl.Collator("en", { numeric: true }).compare;

/** The robot in focus, if there is one. */
export const focus = () => state.robots[state.focused] ?? null;

/** Count on for how long robots have been away. */
export function tick() {
  if (Object.values(state.robots).some(({ presence }) => presence !== "online")) touch();
}

/** Look at another robot. */
export function look(robot) {
  if (!state.robots[robot] || state.focused === robot) return;
  focusOn(robot);
  loadHistory(robot).catch(() => {});
  touch();
}

function focusOn(robot) {
  state.focused = robot;
  sessionStorage.setItem(FOCUSED, robot);
}

/** The one that was in focus before the page was opened anew; another one, if it doesn't come. */
function refocus(robot) {
  const before = sessionStorage.getItem(FOCUSED) ?? robot;
  if (robot === before) focusOn(robot);
  else setTimeout(() => state.focused ?? look(names()[0]), COMES_BACK_MS);
}

/** Who else looks at a robot. */
export const others = (robot) =>
  state.here.filter(
    ({ name, robots }) => ![author(), state.introduced].includes(name) && robots.includes(robot),
  );

/** The robot's call for help, if one is open. */
export const callOf = (robot) => state.help.asking.find((call) => call.robot === robot);

/** The next robot in doubt; from one that isn't, the most urgent. */
export function inDoubt() {
  const robots = state.help.asking.map(({ robot }) => robot);
  return robots[(robots.indexOf(state.focused) + 1) % robots.length];
}

/** Take in a message of the WebSocket. */
export function hear(message) {
  if (message.type === "robot") hearRobot(message.robot);
  if (message.type === "learner") state.learner = message.learner;
  if (message.type === "people") state.here = message.people.here;
  if (message.type === "help") state.help = message.help;
  if (message.type === "correction") hearCorrection(message.correction);
  if (message.type === "episode") loadTally().catch(() => {});
  touch();
}

function hearRobot(robot) {
  robot.heardMs ??= performance.now();
  state.robots[robot.robot] = robot;
  if (!state.focused) refocus(robot.robot);
  if (robot.decision) place(robot);
}

/** Give the proposals their keys; of the robot in focus, also learn which ones it could not do. */
function place(view) {
  const { robot, episode, decision } = view;
  const places = state.places[robot];
  state.places[robot] = arrange(places, episode, decision.proposed, refused(view), Date.now());
  if (robot === state.focused) inquire(view, () => hear({ type: "robot", robot: state.robots[robot] }));
}

export function hearCorrection(view) {
  const { robot, id } = view.correction;
  delete state.sending[id];
  const views = state.corrections[robot] ?? [];
  const known = views.find((other) => other.correction.id === id);
  if (view.status === "pending" && known) return; // An answer may come after what became of it.
  const others = views.filter((other) => other !== known);
  state.corrections[robot] = [view, ...others]
    .sort((one, other) => other.sequence - one.sequence)
    .slice(0, HISTORY);
}

export async function loadTally() {
  state.tally = (await get("episodes?limit=1")).tally;
  touch();
}

/** What was said before this page was opened, of one robot or of all. */
export async function loadHistory(robot) {
  const about = robot ? `&robot=${robot}` : "";
  const { corrections } = await get(`corrections?limit=${robot ? HISTORY : 100}${about}`);
  for (const view of corrections.reverse()) hearCorrection(view);
  touch();
}
