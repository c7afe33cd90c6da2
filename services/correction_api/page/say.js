// Saying something: it goes out under an id of its own, so that it can be sent again safely.
import { newId, post, Problem } from "./api.js";
import { seenStep } from "./pictures.js";
import { author, hearCorrection, state, touch } from "./store.js";

const GIVE_UP_MS = 10_000;
const PAUSE_MS = 500;

/** Say something about a robot. words: kind, and for an override text and hold_steps. */
export async function say(robot, words, begunMs = Date.now()) {
  const { decision, episode } = state.robots[robot];
  const body = {
    ...words,
    id: newId(),
    author: author(),
    begun_ns: begunMs * 1_000_000,
    seen_step: seenStep(robot) ?? decision?.step ?? null,
    ...(decision && { decision: decision.id }),
    ...(episode && { episode }),
  };
  note(robot, { id: body.id, words, status: "sending" });
  try {
    const view = await persist(() => post(`robots/${robot}/corrections`, body));
    hearCorrection(view);
    note(robot, { id: body.id, words, status: view.status, view });
  } catch (error) {
    if (!(error instanceof Problem)) error.message = "the service cannot be reached";
    note(robot, { id: body.id, words, status: "refused", reason: error.message });
  }
}

function note(robot, said) {
  const newer = state.said[robot];
  if (said.status !== "sending" && newer && newer.id !== said.id) return;
  state.said[robot] = said;
  touch();
}

/** Try again while nobody answers, or while the service says that it will work later. */
async function persist(send) {
  const end = Date.now() + GIVE_UP_MS;
  for (;;) {
    try {
      return await send();
    } catch (error) {
      const passing = !(error instanceof Problem) || error.status === 503;
      if (!passing || Date.now() > end) throw error;
      await new Promise((resume) => setTimeout(resume, PAUSE_MS));
    }
  }
}
