// What a key, a click or a finger does; one table for all three. `keys.js` calls `down` when the
// key goes down, and `up`, where an action has it, when the key comes up again. A letter waits first
// (`letters.js`): `down` then gets the moment at which it was pressed.
import { openPalette } from "./palette.js";
import { unsettled } from "./places.js";
import { place, say, sayToAll, settled } from "./say.js";
import { author, callOf, focus, inDoubt, look, names, state, tell, touch } from "./store.js";
import { arrived, named, standing } from "./words.js";

const TAKEN_BACK = ["override", "release", "approve", "edit", "retime", "relabel", "fault", "endorse"];

const on = (act) => (_event, at) => about(act, at);

export const ACTIONS = {
  freeze: { label: "Freeze the robot in focus", urgent: true, down: freeze },
  "freeze-all": { label: "Freeze all robots", urgent: true, down: freezeAll },
  "carry-on": { label: "Let a frozen robot carry on", down: on(carryOn) },
  release: { label: "Release: the policy decides again", down: on(release) },
  approve: { label: "That is right", down: on(approve) },
  endorse: { label: "All so far was right, where nobody spoke", down: on(endorse) },
  slip: { label: "Right, but the hand slipped", down: on(slip) },
  "take-back": { label: "Take back what you said last", down: () => takeBack() },
  palette: { label: "Say it in your own words", down: on(() => openPalette()) },
  ...Object.fromEntries(
    Array.from({ length: 9 }, (_, place) => [
      `propose-${place + 1}`,
      { label: `Say proposal ${place + 1}`, down: on((robot, at) => propose(robot, place, at)) },
    ]),
  ),
  next: { label: "Go to the next robot in doubt", down: next },
  go: { label: "Go to a robot: then its number", digit: go, down: () => {} },
  before: { label: "Go to the robot before", down: () => move(-1) },
  after: { label: "Go to the robot after", down: () => move(1) },
  help: { label: "Show the keys", down: toggleHelp },
};

/** What an action is called. */
export const label = (name) => ACTIONS[name]?.label ?? name;

/** What a person looks at now, and when: a key that waits acts about that, and not about later. */
export const moment = (robot = focus()) =>
  robot && {
    robot: robot.robot,
    looked: { decision: null, ...place(robot.robot) },
    command: robot.command?.text ?? "",
    begunMs: Date.now(),
  };

function about(act, at) {
  const seen = at ?? moment();
  if (seen) act(state.robots[seen.robot], seen);
  else tell("No robot has been heard of yet", "bad");
}

const judge = (robot, words, { looked, begunMs }) =>
  say(robot.robot, { ...looked, ...words }, begunMs);

/** Never asks back, and needs no decision: whatever the robot does, it stands still. */
export function freeze() {
  about((robot) => say(robot.robot, { kind: "pause" }));
}

/** By one request, so that none waits for another, nor for being shown here. */
export function freezeAll() {
  sayToAll();
}

export function carryOn(robot) {
  if (robot.state === "paused") return say(robot.robot, { kind: "resume" });
  return tell(`${robot.robot} is not frozen`, "bad");
}

/** The word that holds goes first; where none does, a frozen robot carries on. */
export function release(robot, at = moment(robot)) {
  if (robot.by === "person") return judge(robot, { kind: "release" }, at);
  if (robot.state === "paused") return carryOn(robot);
  return tell(`Nobody's word holds ${robot.robot}: its policy decides`, "bad");
}

export function approve(robot, at = moment(robot)) {
  if (at.looked.decision) return verdict(robot, "approve", at);
  return tell(`${robot.robot} has decided nothing yet in this episode`, "bad");
}

/** Of this episode, up to the picture that one sees. */
export function endorse(robot, { looked, begunMs } = moment(robot)) {
  const { episode, seen_step } = looked;
  if (!seen_step) return tell(`${robot.robot} has done nothing yet in this episode`, "bad");
  return say(robot.robot, { kind: "endorse", episode, first_step: 0, end_step: seen_step }, begunMs);
}

export function slip(robot, at = moment(robot)) {
  if (at.looked.decision) return verdict(robot, "fault", at);
  return tell(`${robot.robot} has decided nothing yet in this episode`, "bad");
}

/** A word about the command that was in force, which it names. */
const verdict = (robot, kind, at) =>
  retell(robot.robot, `${named({ kind })}: “${at.command}”`, judge(robot, { kind }, at));

function propose(robot, place, at) {
  const places = state.places[robot.robot];
  const text = places?.texts[place];
  if (!text) return tell(`${robot.robot} has no proposal ${place + 1}`, "bad");
  if (!unsettled(places, place, at.begunMs)) return judge(robot, { kind: "override", text }, at);
  return tell(`Proposal ${place + 1} has just become “${text}”: say it again, if you mean that`, "bad");
}

/** The ids of what was taken back. */
export function takenBack() {
  const views = Object.values(state.corrections).flat();
  const retracts = views.filter(
    ({ correction, status }) => correction.kind === "retract" && stands(status),
  );
  return new Set(retracts.map(({ correction }) => correction.target));
}

const stands = (status) => ["pending", "in force", "kept"].includes(status);

/** Whether this person may take it back: one's own, that stands. */
export const mine = ({ correction, status }, gone) =>
  correction.author === author() &&
  TAKEN_BACK.includes(correction.kind) &&
  stands(status) &&
  !gone.has(correction.id);

/** Take back one's own last correction, of whichever robot, or the one that is named. */
export async function takeBack(view) {
  await settled();
  const gone = takenBack();
  const views = Object.values(state.corrections).flat();
  const last = view ?? newest(views.filter((one) => mine(one, gone) || stops(one)));
  if (!last) return tell("There is nothing of yours to take back", "bad");
  const { kind, robot, id } = last.correction;
  if (kind === "pause") return unfreeze(robot);
  const what = `taken back ${named(last.correction)}`;
  return retell(robot, what, say(robot, { kind: "retract", target: id }));
}

/** What was said last; of what was said to several robots at one press, that to the one in focus. */
function newest(views) {
  const [last] = views.sort((one, other) => other.sequence - one.sequence);
  const together = ({ correction }) => correction.begun_ns === last.correction.begun_ns;
  const here = ({ correction }) => correction.robot === state.focused;
  return views.find((one) => here(one) && together(one)) ?? last;
}

/** One's own freeze that still holds: no "carry on" came after it, and the robot didn't go on. */
function stops({ correction, status, receipt, sequence }) {
  const { kind, robot, author: who, episode } = correction;
  if (kind !== "pause" || who !== author() || !stands(status)) return false;
  if (sequence < resumed(robot)) return false;
  const now = state.robots[robot];
  const wentOn = (episode && now?.episode !== episode) || now?.step > (receipt?.step ?? now.step);
  return now?.state === "paused" || !wentOn; // What the robot says comes later than its answer.
}

/** When a robot was last let go, as a sequence; 0: never. */
const resumed = (robot) =>
  Math.max(0, ...standingOf(robot, "resume").map(({ sequence }) => sequence));

const standingOf = (robot, kind) =>
  state.corrections[robot].filter(({ correction, status }) => correction.kind === kind && stands(status));

/** A freeze is taken back by carrying on, where one sees it, unless somebody else has frozen the
 *  robot as well. */
function unfreeze(robot) {
  if (robot !== state.focused) {
    return tell(`${robot} stays frozen, since you don't look at it: go to it to take that back`, "bad");
  }
  const others = standingOf(robot, "pause").filter(
    ({ correction, sequence }) => correction.author !== author() && sequence > resumed(robot),
  );
  if (!others.length) return retell(robot, "freeze taken back", say(robot, { kind: "resume" }));
  const why = `${others[0].correction.author} froze it, too; “Carry on” ends that`;
  return tell(`${robot} stays frozen, since ${why}`, "bad");
}

/** Say in full what became of a word: which command it was about, and of which robot. */
async function retell(robot, what, saying) {
  const id = await saying;
  const view = state.corrections[robot]?.find(({ correction }) => correction.id === id);
  if (view) tell(`${what}, ${robot}: ${standing(view)}`, state.line.mark);
  return id;
}

/** Look at another robot, and say which one that is: whoever goes by keys may not see it. */
function turnTo(robot) {
  look(robot);
  if (focus()) tell(arrived(focus(), callOf(robot)));
}

function next() {
  const robot = inDoubt();
  if (robot) turnTo(robot);
  else tell("No robot is in doubt");
}

export function move(by) {
  const robots = names();
  turnTo(robots[(robots.indexOf(state.focused) + by + robots.length) % robots.length]);
}

/** Go to the how-manieth robot, from 1. */
export function go(number) {
  const robot = names()[number - 1];
  if (robot) turnTo(robot);
  else tell(`There is no robot ${number}`, "bad");
}

export function toggleHelp() {
  state.asking = !state.asking;
  touch();
}
