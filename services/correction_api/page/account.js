// One episode put together: what was in force when, what was said, and what of it still stands.
import { get } from "./api.js";
import { standing as stands } from "./words.js";

export const STEPS_A_SECOND = 50; // The control rate of the robots.

const AMENDS = ["retract", "edit", "retime"];
const GONE = ["refused", "expired"];
const LATER = { episode: "a later one", state: "acting", step: 0 }; // a robot whose episode is over

export const isPolicy = (chosenBy) => /^\d+\.\d+$/.test(chosenBy);

/** The decisions of an episode, which the learner keeps. They never change, so that of those that
 *  are known only what came since is asked for. */
export async function recall(id, known = []) {
  const decisions = [...known];
  for (let first = known.length; first !== null; ) {
    const part = await get(`episodes/${encodeURIComponent(id)}/decisions?first=${first}`);
    decisions.push(...part.decisions);
    first = part.next;
  }
  return decisions;
}

/** Everything that the player draws, from what the API and the learner tell. */
export function assemble(account, decisions) {
  const last = decisions.at(-1)?.step ?? 0;
  const steps = account.episode?.steps ?? last + STEPS_A_SECOND;
  const said = standing(account.corrections, decisions, account.episode ? LATER : null);
  return { account, decisions, steps, said, segments: segments(decisions, account, steps) };
}

/** The commands in force as [from, to) with who chose them; what a person said wins at its step.
 *  Neighbours with the same command and the same chooser are one stretch. */
export function segments(decisions, { corrections }, steps) {
  const events = decisions.map((one) => ({
    from: one.step,
    text: one.executed.text,
    by: one.chosen_by,
  }));
  for (const { correction, receipt } of corrections) {
    if (correction.kind !== "override" || !receipt?.accepted) continue;
    events.push({ from: receipt.step, text: correction.goal.text, by: correction.id });
  }
  events.sort((one, other) => one.from - other.from); // Stable: people after decisions.
  const authors = new Map(corrections.map(({ correction }) => [correction.id, correction.author]));
  const chooser = ({ by }) => authors.get(by) ?? by;
  const found = [];
  for (const event of events) {
    if (found.at(-1)?.from === event.from) found.pop();
    const before = found.at(-1);
    if (before?.text === event.text && chooser(before) === chooser(event)) continue;
    found.push(event);
  }
  return found.map((one, at) => ({ ...one, to: found[at + 1]?.from ?? steps }));
}

/** What was said, each with its words and steps as they stand, whether it was taken back, and its
 *  state in words. robot: as it is now, where that is known. */
export function standing(corrections, decisions, robot = null) {
  const counts = corrections.filter(({ status }) => !GONE.includes(status));
  const amending = counts.filter(({ correction }) => AMENDS.includes(correction.kind));
  const retracted = new Set(
    amending.filter(({ correction }) => correction.kind === "retract").map(target),
  );
  const last = (kind, id) =>
    amending.findLast(
      (view) =>
        view.correction.kind === kind && target(view) === id && !retracted.has(view.correction.id),
    )?.correction;
  const resumes = corrections.filter(
    ({ correction, status }) => correction.kind === "resume" && status === "in force",
  );
  return corrections.map((view) => {
    const said = view.correction;
    const moved = last("retime", said.id) ?? said;
    return {
      view,
      kind: said.kind,
      text: (last("edit", said.id) ?? said).goal?.text ?? null,
      span: moved.first_step === null ? null : [moved.first_step, moved.end_step],
      begun: earlier(begun(said, decisions), heard(view)),
      seen: said.seen_step,
      inForce: view.receipt?.step ?? null,
      retracted: retracted.has(said.id),
      state: retracted.has(said.id) ? "taken back" : state(view, { robot, resumes }),
    };
  });
}

const target = ({ correction }) => correction.target;

/** The step at which the robot heard it, where it was about what the robot did just then. */
function heard({ correction, receipt }) {
  const { target: amended, first_step: first } = correction;
  return receipt?.accepted && amended === null && first === null ? receipt.step : Infinity;
}

/** Nobody begins to speak after they were heard; a robot that waits has no steps meanwhile. */
const earlier = (begun, heard) => (begun === null ? null : Math.min(begun, heard));

/** The step at which somebody began to speak, between the decisions by whose times it is known. */
export function begun({ begun_ns: at }, decisions) {
  const index = decisions.findLastIndex(({ time_ns: time }) => time <= at);
  if (index < 0) return null;
  const { step, time_ns: time } = decisions[index];
  const passed = Math.floor(((at - time) * STEPS_A_SECOND) / 1e9);
  return Math.min(step + passed, decisions[index + 1]?.step ?? step + passed);
}

/** The decisions of a stretch [first, end). */
export const within = (decisions, [first, end]) =>
  decisions.filter(({ step }) => step >= first && step < end);

/** Where something stands that was said, as the live page tells it; now: as there. */
function state(view, now) {
  if (view.status !== "kept") return stands(view, "", now);
  return `kept for the next round${view.reason ? `; ${view.reason}` : ""}`;
}

/** The anatomy of a rollout: why the high level was asked, and how long commands then held. */
export function anatomy(decisions, steps) {
  const rows = new Map();
  decisions.forEach((one, at) => {
    const row = rows.get(one.asked ?? "untold") ?? { count: 0, steps: 0, changed: 0 };
    row.count += 1;
    row.steps += (decisions[at + 1]?.step ?? steps) - one.step;
    row.changed += at > 0 && one.executed.text !== decisions[at - 1].executed.text ? 1 : 0;
    rows.set(one.asked ?? "untold", row);
  });
  return [...rows].map(([asked, row]) => ({ asked, ...row }));
}

/** From the end of saying to in force, ms and control steps, of each override that was obeyed. */
export function delays(said) {
  return said
    .filter(({ kind, view }) => kind === "override" && view.receipt?.accepted)
    .map(({ view: { correction, receipt }, seen, inForce }) => ({
      ms: Math.max(0, (receipt.time_ns - correction.created_ns) / 1e6),
      steps: seen === null ? null : Math.max(0, inForce - seen),
    }));
}

export const median = (values) => {
  const sorted = [...values].sort((one, other) => one - other);
  return sorted.length ? sorted[Math.floor(sorted.length / 2)] : null;
};
