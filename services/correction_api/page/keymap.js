// Which key does what; a person's own choice is kept in this browser.
const KEPT = "hld-keys";
const PLAIN = /^[a-z]$/i;
const MODIFIERS = ["Shift", "Control", "Alt", "Meta", "AltGraph", "CapsLock"];
const NAMES = { Escape: "Esc", ArrowLeft: "←", ArrowRight: "→", " ": "Space" };

/** A key as people read it. */
export const shown = (key) =>
  key
    .split(/\+(?!$)/)
    .map((part) => NAMES[part] ?? (PLAIN.test(part) ? part.toLowerCase() : part))
    .join(" ");

/** Keys that the page or the browser needs; they can't be given away. */
const RESERVED = ["Tab", "Shift+Tab", "Enter"];
/** Keys that always stop; what stops may have another key besides. */
const STOPS = { Escape: "freeze", "Shift+Escape": "freeze-all" };
/** What acts while one types can have these: they write nothing and move nothing. */
const BESIDES = /^(Ctrl\+|Alt\+|Shift\+)*(F\d+|Pause|ScrollLock)$/;

/** Of the live page; another page has its own, see `useKeys`. */
let defaults = {
  ...Object.fromEntries(Array.from({ length: 9 }, (_, at) => [`propose-${at + 1}`, `${at + 1}`])),
  palette: "/",
  freeze: "Escape",
  "freeze-all": "Shift+Escape",
  "carry-on": "c",
  release: "r",
  approve: "y",
  endorse: "Shift+y",
  slip: "f",
  "take-back": "Ctrl+z",
  next: "n",
  go: "g",
  before: "ArrowLeft",
  after: "ArrowRight",
  help: "?",
};

const own = read(); // of all pages

function read() {
  try {
    const kept = JSON.parse(localStorage.getItem(KEPT) ?? "{}");
    const good = ([name, key]) => typeof key === "string" && !objection(name, key);
    return Object.fromEntries(Object.entries(kept).filter(good));
  } catch {
    return {}; // Somebody else's text: the keys are as they come.
  }
}

function keep() {
  localStorage.setItem(KEPT, JSON.stringify(own));
}

/** The actions of another page, with the keys that they come with, besides the stop for all. */
export function useKeys(table) {
  defaults = { ...table, "freeze-all": defaults["freeze-all"] };
}

/** An action of another part of the page, with the key that it comes with (see `keys.js`). */
export function addDefault(name, key) {
  defaults[name] = key;
}

export const keyOf = (name) => own[name] ?? defaults[name];
export const actionOf = (key) =>
  STOPS[key] ?? Object.keys(defaults).find((name) => keyOf(name) === key);
export const changed = () => Object.keys(defaults).some((name) => name in own);

/** Why an action can't have a key at all; "" if it can. */
function objection(name, key) {
  if (RESERVED.includes(key)) return `${shown(key)} is needed to move about in the page.`;
  if (key in STOPS) return STOPS[key] === name ? "" : `${shown(key)} always stops robots.`;
  if (!Object.values(STOPS).includes(name) || BESIDES.test(key)) return "";
  return `${shown(key)} may be typed, and what stops robots acts then, too: take F1 to F12 or Pause.`;
}

/** Give an action another key; returns why not, or "". label: what actions are called. */
export function remap(name, key, label) {
  const why = objection(name, key);
  if (why) return why;
  const other = actionOf(key);
  if (other && other !== name) {
    return `${shown(key)} is taken: it does “${label(other)}”. Give that another key first.`;
  }
  own[name] = key;
  if (key === defaults[name]) delete own[name];
  keep();
  return "";
}

export function reset() {
  for (const name of Object.keys(defaults)) delete own[name];
  keep();
}

/** The key of an event by name, such as "y", "Shift+Escape" or "Ctrl+z"; null for Shift alone. */
export function pressed(event) {
  const composing = event.key === "Process" && event.code === "Escape"; // It has no name just then.
  const key = composing ? "Escape" : event.key;
  if (!key || MODIFIERS.includes(key)) return null;
  const parts = [];
  const typed = event.getModifierState?.("AltGraph"); // A sign that needs AltGr to be typed.
  if ((event.ctrlKey || event.metaKey) && !typed) parts.push("Ctrl");
  if (event.altKey && !typed) parts.push("Alt");
  if (event.shiftKey && (key.length > 1 || PLAIN.test(key))) parts.push("Shift");
  return [...parts, PLAIN.test(key) ? key.toLowerCase() : key].join("+");
}

/** A key as `aria-keyshortcuts` wants it. */
export const aria = (name) => keyOf(name).replace("Ctrl", "Control").replace(/^ $/, "Space");
