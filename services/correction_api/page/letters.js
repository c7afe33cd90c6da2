// A letter that does something may as well be the first one of a phrase: it waits for another one.
// Two that do something and begin no word act both, in order.
import { moment as now } from "./actions.js";
import { wordsOf } from "./fuzzy.js";
import { openPalette } from "./palette.js";
import { listed } from "./scene.js";
import { focus, state, tell } from "./store.js";

/** Longer than people who look for their keys take for the next letter of a word. */
const LETTER_MS = 500;
const NUMBER_MS = 2000;
const DIGIT = /^\d$/;
const LETTERS = /^\p{L}{2}$/u;
/** Two letters with which English words begin; others do where a command or the prompt has such a word. */
const BEGIN =
  /^(.[aeiou]|[aeiou].|[bcfgkps]l|[bcdfgkptw]r|[bcdhlmrst]y|[cgpstw]h|[dst]w|kn|s[ckmnpqt]|ps|qu|.*[^a-z].*)$/i;

let waiting = null; // {sign, key, action, moment, timer, before, line}

/**
 * Let an action wait. sign: what its key would write; moment: what was seen when it went down,
 * which is what it is about. An action with `digit` waits for the number that belongs to it.
 */
export function wait(sign, key, action, moment) {
  const timer = setTimeout(settle, action.digit ? NUMBER_MS : LETTER_MS);
  const before = state.line;
  tell(`${sign} …: ${action.label}`, "wait");
  waiting = { sign, key, action, moment, timer, before, line: state.line };
}

/**
 * Whether the next key belongs to the letter that waits, and is used up by that. sign: what it would
 * write; next: the action that it has, if any.
 */
export function follow(event, sign, next) {
  if (!waiting) return false;
  const { sign: first, action, key } = waiting;
  if (event.repeat && event.key === key) return true;
  if (action.digit && DIGIT.test(sign)) {
    drop();
    action.digit(Number(sign));
  } else if (event.key === "Backspace") drop();
  else if (next && !next.up && LETTERS.test(first + sign) && !begins(first + sign)) return both(next);
  else if (first && sign && !DIGIT.test(sign)) write(first + sign);
  else if (first && event.key === "Dead") return write(first); // What is composed comes after it.
  else return settle() && event.key === "Enter";
  return true;
}

/** Whether a word may begin with these letters. */
function begins(letters) {
  if (BEGIN.test(letters)) return true;
  const known = [...listed(state.focused), focus()?.prompt ?? ""].flatMap(wordsOf);
  return known.some((word) => word.startsWith(letters.toLowerCase()));
}

/** What waits acts now, and so does the next one; unless that has to wait: for its number, or
 *  because another robot has come into focus, which nobody has seen yet. */
function both(next) {
  const { focused } = state;
  settle();
  if (next.digit || state.focused !== focused) return false;
  next.down(null, now());
  return true;
}

/** It was a command: it acts now. */
export function settle() {
  const last = drop();
  last?.action.down(null, last.moment);
  return true;
}

/** It does nothing any more. */
export function drop() {
  const last = waiting;
  waiting = null;
  clearTimeout(last?.timer);
  if (last && state.line === last.line) tell(last.before.text, last.before.mark);
  return last;
}

function write(text) {
  drop();
  openPalette(text);
  return false;
}
