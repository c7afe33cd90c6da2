// Whether what somebody taught is in what their robot runs: a later version has it, too, unless
// somebody went back to weights from before.
import { get } from "./api.js";
import { state, touch } from "./store.js";

const RETRY_MS = 10_000;

let history = null; // versions and rulings, as `GET policy` tells them
const asked = new Set(); // the versions for which it was asked

/**
 * Where a lesson stands on its robot: words that go on after "learned in 1.2", and whether it was
 * lost again.
 */
export function lesson({ learned_in: learned, correction }) {
  const robot = state.robots[correction.robot];
  if (!learned || !robot) return { words: "", lost: false };
  const later = compare(robot.version, learned) > 0;
  return place(learned, robot, later ? known(robot.version) : null);
}

/** The same, from what is known of versions; null: nothing, or it doesn't matter. */
export function place(learned, { robot, version: runs }, told) {
  const order = compare(runs, learned);
  const same = number(runs) === number(learned); // Also where a learner has taken over the store.
  if (same) return { words: `, which ${robot} runs`, lost: false };
  if (order < 0) return { words: `; ${robot} still runs ${runs}`, lost: false };
  const [has, needs] = [runs, learned].map((version) => source(number(version), told));
  if (!has || !needs) return { words: `; ${robot} runs ${runs}`, lost: false };
  if (has.round >= needs.round) return { words: `; ${robot} has it in ${runs}`, lost: false };
  const back = has.version === runs ? `not in ${runs}` : `rolled back to ${has.version} by ${runs}`;
  return { words: `, ${back}, which ${robot} runs`, lost: true };
}

/** The version whose weights these are, and the round that trained it; null: not known. */
function source(wanted, told) {
  const one = told?.versions.find((version) => version.number === wanted);
  if (!one) return null;
  if (one.again !== null) return source(one.again, told);
  const promoted = told.rulings.find(
    ({ made, ruling }) => made === wanted && ruling.verb === "promote",
  );
  const round = one.round ?? promoted?.ruling.round ?? (wanted ? null : 0);
  return round === null ? null : { version: one.version, round };
}

/** Asked for once for each version that is met; the learner may be away. */
function known(version) {
  if (!asked.has(version)) {
    asked.add(version);
    get("policy").then(
      (told) => {
        history = told;
        touch();
      },
      () => setTimeout(() => asked.delete(version), RETRY_MS),
    );
  }
  return history;
}

const parts = (version) => version.split(".").map(Number);
const number = (version) => parts(version)[1];

function compare(one, other) {
  const [[epoch, count], [epochs, counts]] = [parts(one), parts(other)];
  return epoch - epochs || count - counts;
}
