// The head of the live page: besides what all pages show, the learner, success so far, who asks for
// help, and the keys.
import { ACTIONS, toggleHelp } from "./actions.js";
import { Head } from "./head.js";
import { html } from "./html.js";
import { aria, keyOf, shown } from "./keymap.js";
import { state } from "./store.js";
import { count, works } from "./words.js";

export function Overview() {
  const told = html`
    <div class="told"><${Learner} learner=${state.learner} /><${Tally} tally=${state.tally} /></div>
  `;
  const keys = html`
    <button class="help" onClick=${toggleHelp} aria-keyshortcuts=${aria("help")}>
      Keys<kbd aria-hidden="true">${shown(keyOf("help"))}</kbd>
    </button>
  `;
  return html`<${Head} here="./" told=${told} first=${html`<${InDoubt} help=${state.help} />`} last=${keys} />`;
}

function InDoubt({ help }) {
  if (!help.asking.length) return null;
  return html`
    <button class="in-doubt" onClick=${ACTIONS.next.down} aria-keyshortcuts=${aria("next")}>
      ${help.asking.length} in doubt<kbd aria-hidden="true">${shown(keyOf("next"))}</kbd>
    </button>
  `;
}

function Learner({ learner }) {
  if (!learner || learner.presence === "unseen") {
    return html`<p class="learner"><span class="doing idle">no learner heard of</span></p>`;
  }
  const does = learner.presence === "online" ? learner.state : learner.presence;
  return html`
    <p class="learner" title=${learner.reason}>
      <span class=${`doing ${does}`}>learner ${does}</span>
      ${works(learner) && html`<progress max="1" value=${learner.progress} aria-label=${does} />`}
      <span class="facts">version <b>${learner.version}</b></span>
      <span class="facts">· ${count(learner.corrections, "correction")} since</span>
      ${learner.outbox > 0 && html`<span class="facts">· ${learner.outbox} wait</span>`}
    </p>
  `;
}

/** A version keeps its number when another learner takes over the store, and its success. */
function named(tally) {
  const known = new Map();
  for (const { version, episodes, successes } of tally) {
    const number = version.split(".")[1];
    const before = known.get(number) ?? { episodes: 0, successes: 0 };
    known.delete(number);
    const sum = { episodes: episodes + before.episodes, successes: successes + before.successes };
    known.set(number, { version, ...sum });
  }
  return [...known.values()];
}

/** Of the episodes in which people could speak, the newest version first: it is shown where there is
 *  room for one alone. */
function Tally({ tally }) {
  if (!tally.length) return null;
  return html`
    <ul class="tally" aria-label="Success with people so far, by version">
      ${named(tally)
        .slice(-2)
        .reverse()
        .map(
          ({ version, episodes, successes }, at) => html`
            <li key=${version} title=${`${successes} of ${episodes} episodes in service`}>
              ${at === 0 ? "with people: " : "· "}${version}${" "}
              <b>${Math.round((100 * successes) / episodes)} %</b>, n = ${episodes}
            </li>
          `,
        )}
    </ul>
  `;
}
