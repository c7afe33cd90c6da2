// The head of the page: the learner, and how often each version succeeds.
import { html } from "./html.js";
import { next, setName, state, touch } from "./store.js";

export function Fleet() {
  return html`
    <header class="fleet">
      <h1><img src="icon.svg" alt="" width="22" height="22" /> hl-dagger</h1>
      <${Learner} learner=${state.learner} />
      <${Tally} tally=${state.tally} />
      <${InDoubt} help=${state.help} />
      <div class="you">
        <label>
          You are
          <input
            name="author"
            size="9"
            maxlength="64"
            value=${state.name}
            onInput=${(event) => setName(event.target.value)}
          />
        </label>
        <label title="1–9, y, r, / and Esc act on the robot in focus, n goes to the next in doubt">
          <input type="checkbox" name="keys" checked=${state.keys} onChange=${toggleKeys} />
          keys
        </label>
      </div>
    </header>
  `;
}

function toggleKeys(event) {
  state.keys = event.target.checked;
  touch();
}

function InDoubt({ help }) {
  if (!help.asking.length) return null;
  return html`
    <button class="in-doubt" onClick=${next} aria-keyshortcuts="n" title="Go to the next one">
      <kbd>n</kbd>${help.asking.length} in doubt
    </button>
  `;
}

function Learner({ learner }) {
  if (!learner || learner.presence === "unseen") {
    return html`<p class="learner">No learner has been heard of. Corrections are kept for it.</p>`;
  }
  const online = learner.presence === "online";
  const waiting = learner.outbox ? `, ${learner.outbox} records wait for it` : "";
  return html`
    <p class="learner">
      <span class=${`doing ${online ? learner.state : learner.presence}`}>
        learner ${online ? learner.state : learner.presence}
      </span>
      ${["training", "judging"].includes(learner.state) &&
      html`<progress max="1" value=${learner.progress} aria-label=${learner.state} />`}
      <span class="facts">
        version <b>${learner.version}</b> · round ${learner.round} ·${" "}
        ${learner.corrections} corrections since${waiting}
        ${learner.reason && html` · ${learner.reason}`}
      </span>
    </p>
  `;
}

function Tally({ tally }) {
  if (!tally.length) return null;
  return html`
    <ul class="tally" aria-label="Success so far">
      ${tally.slice(-4).map(({ version, episodes, successes }) => {
        const rate = successes / episodes;
        return html`
          <li key=${version}>
            <span>${version}</span>
            <meter min="0" max="1" value=${rate} />
            <b>${Math.round(100 * rate)} %</b>
            <small>${successes} of ${episodes}</small>
          </li>
        `;
      })}
    </ul>
  `;
}
