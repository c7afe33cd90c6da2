// The keys of the player: what they are, which others they shall be, or that none acts.
import { html } from "./html.js";
import { changed, keyOf, pressed, remap, reset, shown, useKeys } from "./keymap.js";
import { Aloud } from "./line.js";

const LABELS = {
  "player-back": "One decision back",
  "player-on": "One decision on",
  "player-play": "Play or pause",
  "player-begin": "A stretch begins here",
  "player-end": "A stretch ends here",
  "player-closer": "Zoom in",
  "player-farther": "Zoom out",
  "player-whole": "The whole timeline",
};

const WAITS = "press a key …"; // Seen and heard alike.

/** Whether single keys act. */
export const singleKeys = { act: true };

let waits = null; // the action that gets the next key
let conflict = "";
let draw = () => {};

useKeys({
  "player-back": ",",
  "player-on": ".",
  "player-play": " ",
  "player-begin": "[",
  "player-end": "]",
  "player-closer": "+",
  "player-farther": "-",
  "player-whole": "0",
});
document.addEventListener("keydown", take, true);

function take(event) {
  const key = pressed(event);
  if (!waits || !key) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  conflict = key === "Escape" ? "" : remap(waits, key, (name) => LABELS[name]);
  if (!conflict) waits = null;
  draw();
}

export function PlayerKeys({ touch }) {
  draw = touch;
  return html`
    <details class="small">
      <summary>Keys</summary>
      <p>Press a key here to change it; Esc keeps it.</p>
      ${conflict && html`<${Aloud} class="notice">${conflict}<//>`}
      <ul>
        ${Object.keys(LABELS).map((name) => html`<${Row} key=${name} name=${name} />`)}
      </ul>
      <label>
        <input type="checkbox" name="keys" checked=${singleKeys.act} onChange=${turn} />
        Single keys act
      </label>
      <button onClick=${asTheyCame} disabled=${!changed()}>Reset all</button>
    </details>
  `;
}

const Row = ({ name }) => html`
  <li>
    ${LABELS[name]}${" "}
    <button
      aria-label=${`Key for: ${LABELS[name]}, ${waits === name ? WAITS : `now ${shown(keyOf(name))}`}`}
      onClick=${() => begin(name)}
    >
      ${waits === name ? WAITS : html`<kbd>${shown(keyOf(name))}</kbd>`}
    </button>
  </li>
`;

function begin(name) {
  waits = waits === name ? null : name;
  conflict = "";
  draw();
}

function turn(event) {
  singleKeys.act = event.target.checked;
  draw();
}

function asTheyCame() {
  reset();
  conflict = "";
  draw();
}
