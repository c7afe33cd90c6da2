// Saying something: it goes out under an id of its own, so that it can be sent again safely.
import { newId, post, Problem } from "./api.js";
import { seen } from "./pictures.js";
import { author, hearCorrection, state, tell, touch } from "./store.js";
import { halted, named, outcome } from "./words.js";

const GIVE_UP_MS = 10_000;
const PAUSE_MS = 500;
const SAY_MS = 3000; // The service waits 2 s for a receipt; who waits longer hangs.
const STOP_MS = 120_000; // So long a freeze is tried: as long as the service asks a robot.
/** Of the past: they name what they are about themselves. */
const AFTERWARDS = ["retract", "edit", "retime", "relabel", "endorse"];

const open = new Set(); // ids of what was said here and has no receipt yet

let last = Promise.resolve();

/**
 * Say something about a robot. words: kind, and what that kind needs; begunMs: when the person
 * began. What words say of decision, episode and seen_step counts: what is spoken is about what was
 * seen when it began. Goes out at once; resolves, when it is known what became of it, to its id, or
 * to null where it was not taken.
 */
export function say(robot, words, begunMs = Date.now()) {
  last = words.kind === "pause" ? stop([robot], begunMs) : send(robot, words, begunMs);
  return last;
}

/** When what was said last is in the log, or was never taken. */
export const settled = () => last;

async function send(robot, words, begunMs) {
  const seen = AFTERWARDS.includes(words.kind) ? {} : place(robot);
  const body = { ...seen, ...words, id: newId(), author: author(), begun_ns: begunMs * 1_000_000 };
  const what = `${named(words)}, ${robot}`;
  state.sending[body.id] = { id: body.id, robot, words, at: Date.now(), status: "sending" };
  tell(`${what}: sending …`, "wait");
  try {
    const view = await persist(() => post(`robots/${robot}/corrections`, body, SAY_MS), what);
    tell(...outcome(take(view)));
    return body.id;
  } catch (error) {
    return refuse(body.id, what, error);
  }
}

/** Take in an answer; the WebSocket may have told more meanwhile. */
function take(view) {
  hearCorrection(view);
  touch();
  const { robot, id } = view.correction;
  const now = state.corrections[robot].find((known) => known.correction.id === id) ?? view;
  if (now.status === "pending") open.add(id);
  return now;
}

/** A message came: say what became of what was pending here. */
export function settle({ type, correction: view }) {
  if (type !== "correction" || view.status === "pending" || !open.delete(view.correction.id)) return;
  tell(...outcome(view));
}

/** It was not taken, and is shown as such. */
function refuse(id, what, error) {
  const reason = error.message;
  const refused = state.sending[id];
  if (refused) Object.assign(refused, { status: "refused", reason });
  tell(`${what}: refused, since ${reason}`, "bad");
  return null;
}

/** Freeze every robot that the service has heard of, also those that this page does not show. */
export function sayToAll(begunMs = Date.now()) {
  last = stop(null, begunMs);
}

/** Freeze these robots, or all. It is about no episode, and is tried until they stand still. */
async function stop(robots, begunMs) {
  const body = { id: newId(), author: author(), begun_ns: begunMs * 1_000_000 };
  const what = robots ? `freeze, ${robots}` : "Freeze all";
  const [robot] = robots ?? [];
  const shown = { id: body.id, robot, words: { kind: "pause" }, at: Date.now(), status: "sending" };
  if (robot) state.sending[body.id] = shown;
  tell(`${what}: sending …`, "wait");
  try {
    const attempt = () => post("pause", { ...body, ...(robots && { robots }) }, SAY_MS);
    const told = await persist(attempt, what, { forMs: STOP_MS, missing });
    delete state.sending[body.id];
    const taken = told.robots.flatMap(({ correction }) => (correction ? [take(correction)] : []));
    const [view] = robots ? taken : [];
    tell(...(view ? outcome(view) : halted(told.robots)));
    return view?.correction.id ?? null;
  } catch (error) {
    if (robot) return refuse(body.id, what, error);
    return tell(`${what}: some may move on, since ${error.message}`, "bad");
  }
}

/** Of which robots nothing could be kept yet; nothing where all were told. */
const missing = ({ robots }) =>
  robots.some(({ correction, status }) => !correction && status === "refused") && halted(robots)[0];

/** What the person looks at: the picture's step, the newest decision, the episode. */
export function place(robot) {
  const { decision, episode } = state.robots[robot];
  const picture = seen(robot);
  const step = picture?.episode === episode ? picture.step : (decision?.step ?? null);
  return {
    seen_step: step,
    ...(decision && { decision: decision.id }),
    ...(episode && { episode }),
  };
}

/**
 * Try again while nobody answers, or while the service says that it will work later, and say so:
 * the same id is said once. missing(answer): why it is no answer yet, if so.
 */
async function persist(attempt, what, { forMs = GIVE_UP_MS, missing = () => "" } = {}) {
  const began = Date.now();
  for (;;) {
    const late = Date.now() > began + forMs;
    let reason = "";
    try {
      const answer = await attempt();
      reason = missing(answer);
      if (late || !reason) return answer;
    } catch (error) {
      const passing = !(error instanceof Problem) || error.status === 503;
      if (!passing || late) throw error;
      reason = error.message;
    }
    const seconds = Math.round((Date.now() - began) / 1000);
    tell(`${what}: ${reason}; trying again, for ${seconds} s so far …`, "bad");
    await new Promise((resume) => setTimeout(resume, PAUSE_MS));
  }
}
