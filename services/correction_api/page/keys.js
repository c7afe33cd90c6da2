// Keys: a table of actions by key. They rest while somebody types, and can be turned off; those
// that stop a robot never rest.
//
// Another part of the page adds an action with `addAction("speak", " ", {label, down, up})`: `down`
// is called once when the key goes down, `up` when it comes up (with the event) or the window loses
// the keyboard. An action with `digit` is called by that with the number that is typed next.
import { ACTIONS, label, moment } from "./actions.js";
import { actionOf, addDefault, pressed, remap } from "./keymap.js";
import { drop, follow, settle, wait } from "./letters.js";
import { closePalette, openPalette } from "./palette.js";
import { state, tell, touch } from "./store.js";

const LETTER = /^\p{L}$/u;
const PRESSED = "button, a, summary, [type=checkbox]"; // What Space presses.
const FIELDS = "input:not([type=checkbox]), select, textarea, [contenteditable]";

let held = null; // {key, action}: an action whose key is down and that wants to know when it is up

/** Let a key do something that is not in the table yet. */
export function addAction(name, key, action) {
  ACTIONS[name] = action;
  addDefault(name, key);
}

export function listen() {
  document.addEventListener("keydown", down, true);
  document.addEventListener("keyup", (event) => held?.key === event.key && letGo(event), true);
  document.addEventListener("pointerdown", settle, true);
  window.addEventListener("blur", () => letGo());
}

/** Wait for a key that an action shall have; `state.capture` names the action. */
export function capture(name) {
  state.capture = state.capture === name ? null : name;
  touch();
}

function down(event) {
  const key = pressed(event);
  if (!key || state.locked) return;
  const name = actionOf(key);
  const action = ACTIONS[name];
  if (event.isComposing && !action?.urgent) return; // It belongs to the sign that is being composed.
  if (state.capture && !(action?.urgent && name !== state.capture)) return take(event, key);
  if (action?.urgent) stop(event, action);
  else if (event.target.matches?.(FIELDS)) return;
  else if (state.asking && name !== "help") return;
  else if (state.keys) act(event, key, action);
}

function stop(event, action) {
  state.capture = null;
  drop();
  if (event.key !== "Escape" || event.shiftKey) event.preventDefault(); // Else the browser acts, too.
  if (!event.repeat) action.down(event);
  closePalette();
  if (event.target.matches?.(FIELDS)) event.target.blur();
}

function act(event, key, action) {
  const sign = signOf(event, key);
  if (follow(event, sign, action)) event.preventDefault();
  else if (action?.digit || (action && !action.up && LETTER.test(sign))) begin(event, sign, action);
  else if (action) run(event, action);
  else if (sign && sign !== " ") openPalette(); // The letter goes into the field.
}

function begin(event, sign, action) {
  event.preventDefault();
  if (!event.repeat) wait(sign, event.key, action, moment());
}

function run(event, action) {
  if (!(event.key === " " && event.target.matches?.(PRESSED))) event.preventDefault();
  if (event.repeat) return;
  if (action.up) held = { key: event.key, action };
  action.down(event);
}

/** What a key writes into a field; "" where that is nothing. */
const signOf = (event, key) => (event.key.length === 1 && !/^(Ctrl|Alt)\+/.test(key) ? event.key : "");

function letGo(event) {
  const { action } = held ?? {};
  held = null;
  action?.up?.(event);
}

/** The next key is what an action shall have from now on. */
function take(event, key) {
  event.preventDefault();
  event.stopPropagation();
  const name = state.capture;
  const why = remap(name, key, label);
  if (why) return tell(why, "bad");
  state.capture = null;
  return tell(`“${label(name)}” has another key now`, "good");
}
