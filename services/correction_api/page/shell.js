// What all pages but the live one have in common: the head, the token, and drawing at the next frame.
import { get, onRefused } from "./api.js";
import { Head } from "./head.js";
import { html, render } from "./html.js";
import { actionOf, pressed } from "./keymap.js";
import { Aloud, Line } from "./line.js";
import { Lock } from "./lock.js";
import { sayToAll } from "./say.js";
import { author, onChange, state } from "./store.js";

/** Under which id this person's words go; the name is kept as on the live page. */
export const person = {
  get id() {
    return author();
  },
};

let locked = false;

/**
 * Show a page: `view()` is drawn anew after each `touch()`. Where a token is needed, it is asked
 * for, at first or later; `start` runs once the API can be read.
 */
export function page(here, view, start) {
  let waiting = false;
  const draw = () => {
    waiting = false;
    const head = html`<${Head} here=${here} told=${html`<${Line} />`} />`;
    render(locked ? html`<${Lock} />` : html`${head}${view()}`, document.body);
  };
  const touch = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  };
  onChange(draw);
  document.addEventListener("keydown", stop);
  onRefused(() => {
    locked = true;
    touch();
  });
  get("me")
    .then(({ person: known }) => Object.assign(state, { person: known, name: known ?? state.name }))
    .catch(() => {}) // Refused, or not there: then `start` tells.
    .then(() => locked || start(touch))
    .finally(touch);
  return touch;
}

/** The one key that works on all pages, also while one types. */
function stop(event) {
  if (actionOf(pressed(event)) !== "freeze-all") return;
  event.preventDefault();
  sayToAll();
}

/** What went wrong, where it matters. */
export const Notice = ({ text }) => text && html`<${Aloud} class="notice">${text}<//>`;

export const percent = (share) => `${Math.round(100 * share)} %`;

/** "63 % (43 to 79), n = 24" */
export const told = (share) =>
  share &&
  `${percent(share.share)}${share.low === null ? "" : ` (${Math.round(100 * share.low)} to ${Math.round(100 * share.high)})`}, n = ${share.n}`;

export const when = (ns) =>
  new Date(ns / 1e6).toLocaleString([], { dateStyle: "medium", timeStyle: "short", hourCycle: "h23" });

/** Do something now and then while the page can be seen, and is let in. */
export function every(seconds, work) {
  const look = () => document.visibilityState === "visible" && !locked && work();
  setInterval(look, 1000 * seconds);
  document.addEventListener("visibilitychange", look);
}
