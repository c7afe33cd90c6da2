// How what was said, and what became of it, is put into words.
const KINDS = {
  override: "command",
  release: "release",
  approve: "that was right",
  pass: "nothing to say",
  pause: "freeze",
  resume: "carry on",
  retract: "taken back",
  edit: "reworded",
  retime: "moved",
  relabel: "relabelled",
  fault: "the hand slipped",
  endorse: "all so far was right",
};

/** What kind of thing was said, as people call it. */
export const called = (kind) => KINDS[kind] ?? kind;

/** What was said, in short: the command in quotes, or what it does. */
export const named = ({ kind, text, goal }) =>
  (text ?? goal?.text) ? `“${text ?? goal.text}”` : called(kind);

const ABOUT = ["retract", "retime"]; // They have no words but those of what they are about.

/** The same, with what it takes back or moves, which is one of `views`. */
export function namedAmong(words, views) {
  if (!ABOUT.includes(words.kind)) return named(words);
  const meant = views.find(({ correction }) => correction.id === words.target);
  return `${called(words.kind)}: ${meant ? named(meant.correction) : "something said before"}`;
}

/** What became of a correction: a text and a mark for the line that is read out. */
export function outcome(view) {
  const what = `${named(view.correction)}, ${view.correction.robot}`;
  const bad = ["refused", "expired"].includes(view.status);
  const mark = bad ? "bad" : view.status === "pending" ? "wait" : "good";
  return [`${what}: ${standing(view)}`, mark];
}

/** Where a correction stands: pending, in force since a step or up to one, learned in a version;
 *  lesson: on which robot that is in force; now: see `term`, and the id of whoever reads as `me`. */
export function standing(view, lesson = "", now = {}) {
  const { status, reason, learned_in, held_out, replaced_by } = view;
  switch (status) {
    case "sending":
      return "sending …";
    case "pending":
      return "pending";
    case "refused":
    case "expired":
      return `${status}, since ${reason}`;
  }
  const force = status === "kept" ? "kept for the learner" : inForce(view, now);
  const learned = learned_in ? ` → learned in ${learned_in}${lesson}` : held_out ? " → held out as a test" : "";
  return force + ended(replaced_by, now.me) + learned;
}

const HOLDS = ["override", "pause"]; // All other kinds are over as soon as the robot heard them.

/**
 * Until when what was said holds, or held: a control step, "over" where only that is known, or null
 * while nobody can say. now: the robot as it is seen, and the resumes that it obeyed, as
 * `{ robot, resumes }`.
 */
export function term({ correction, receipt, replaced_by, sequence }, { robot, resumes = [] }) {
  const ends = [];
  if (replaced_by) ends.push(replaced_by.step);
  if (correction.hold_steps) ends.push(receipt.step + correction.hold_steps);
  if (correction.kind === "pause") {
    const lifts = resumes.filter((one) => one.sequence > sequence);
    if (lifts.some((one) => one.correction.episode !== correction.episode)) return "over";
    ends.push(...lifts.map((one) => one.receipt.step));
  }
  if (ends.length) return Math.min(...ends);
  const gone = robot && robot.episode !== correction.episode; // Also between two episodes.
  const free = correction.kind === "override" || (robot?.episode && robot.state !== "paused");
  return gone && free ? "over" : null;
}

/** Whether it doesn't hold any more. */
export function over(view, now) {
  const { correction, status } = view;
  if (status !== "in force" || !HOLDS.includes(correction.kind)) return false;
  const end = term(view, now);
  const another = now.robot?.episode && now.robot.episode !== correction.episode;
  return end !== null && (end === "over" || another || end <= (now.robot?.step ?? 0));
}

function inForce(view, now) {
  const { step } = view.receipt;
  if (!HOLDS.includes(view.correction.kind)) return `heard at step ${step}`;
  const end = term(view, now);
  if (end === null) return `in force since step ${step}`;
  if (end === "over") return `in force from step ${step}, until its episode ended`;
  if (end > step) return `in force ${step}–${end}`;
  return view.correction.kind === "pause" ? `stood still at step ${step}` : `in force at step ${step} only`;
}

/** Whose later word it was that holds instead. */
const ended = (by, me) =>
  by ? `, ${by.kind === "override" ? "replaced" : "lifted"} by ${by.author === me ? "you" : by.author}` : "";

/** That somebody else's word holds instead of one's own: a text and a mark for the line. */
export const overruled = (view) => [
  `${named(view.correction)}, ${view.correction.robot}: ${standing(view)}`,
  "bad",
];

const NAMED = 3;

/** What became of freezing all robots: a text and a mark for the line that is read out. */
export function halted(robots) {
  const others = robots.filter(({ status }) => status !== "in force");
  const still = robots.length - others.length;
  if (!robots.length) return ["No robot has been heard of yet", "bad"];
  if (!others.length) return [frozen(robots), "good"];
  const told = others.slice(0, NAMED).map(({ robot, status, reason }) => `${robot} ${status} (${reason})`);
  if (others.length > NAMED) told.push(`${others.length - NAMED} more`);
  return [`${still} of ${robots.length} robots are frozen; ${told.join(", ")}`, "bad"];
}

function frozen(robots) {
  if (robots.length === 1) return `${robots[0].robot} is frozen`;
  return robots.length === 2 ? "Both robots are frozen" : `All ${robots.length} robots are frozen`;
}

/** "1 correction", "2 corrections" */
export const count = (number, thing) => `${number} ${thing}${number === 1 ? "" : "s"}`;

const LETTERS = { ß: "ss", æ: "ae", œ: "oe", ø: "o", ł: "l", đ: "d", ð: "d", þ: "th", ı: "i" };

/** The id under which a person's words go: their name in plain letters. */
export function idOf(name) {
  const plain = name.toLowerCase().replace(/[ßæœøłđðþı]/g, (letter) => LETTERS[letter]);
  const bare = plain.normalize("NFKD").replace(/\p{M}/gu, "");
  return bare.replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 64) || "person";
}

export const percent = (score) => (score < 0.005 ? "0 %" : `${Math.round(100 * score)} %`);

/** The time of day; midnight is 00:00:00. */
export const clock = (ms) => new Date(ms).toLocaleTimeString([], { hourCycle: "h23" });

const MINUTES_FROM_S = 120;

/** What a robot does, in a word or two; heardMs: when that was told, by this page's clock. It is told
 *  once that a robot has fallen silent, and the time goes on. */
export const doing = ({ presence, state, age_s, heardMs }) => {
  if (presence === "online") return state === "paused" ? "frozen" : state;
  const silent_s = age_s + (performance.now() - heardMs) / 1000;
  if (silent_s < MINUTES_FROM_S) return `${presence} for ${Math.round(silent_s)} s`;
  return `${presence} for ${Math.floor(silent_s / 60)} min`;
};

/** Whether the learner makes a version just now. */
export const works = (learner) =>
  learner?.presence === "online" && ["training", "judging"].includes(learner.state);

/** Which robot one has gone to, and why that may need one, or else what it does. */
export const arrived = (robot, call) =>
  `${robot.robot} is in focus: ${call ? doubt(call) : doing(robot)}`;

/** Why a robot asks for help. */
export const doubt = (call) =>
  call.reason === "stuck" ? "stuck" : `in doubt ${percent(call.doubt)}`;
