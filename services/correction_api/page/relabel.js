// "This should have been …": a stretch of an episode that is over, and the command for it.
import { Problem, get, newId, post } from "./api.js";
import { within } from "./account.js";
import { Component, html } from "./html.js";
import { Aloud } from "./line.js";
import { person } from "./shell.js";
import { verdict } from "./verdict.js";

const SUGGESTED = 6;
const UNHEARD = "The service cannot be reached: whether it was kept is not known. Try again, it is kept once.";
const PAUSE_MS = 150; // after the last letter, before the robot is asked

let attempt = { words: "", id: "" }; // The same words again are the same correction.

/** The form for a stretch; `close` ends it, `said` is called with the problem, "" if it was kept. */
export function Relabel({ episode, span, bank, setSpan, close, said, begunNs, problem }) {
  const covered = within(episode.decisions, span);
  const proposed = suggestions(covered);
  const send = async (body) => {
    const whole = { first_step: span[0], end_step: span[1], begun_ns: begunNs, ...body };
    const words = JSON.stringify(whole);
    if (attempt.words !== words) attempt = { words, id: newId() };
    try {
      await say(episode, { ...whole, id: attempt.id });
      said("");
    } catch (error) {
      said(error instanceof Problem ? error.message : UNHEARD);
    }
  };
  const submit = (event) => {
    event.preventDefault();
    send({ kind: "relabel", text: event.target.elements.text.value });
  };
  const fill = (event, text) => {
    const field = event.target.closest("form").elements.text;
    field.value = text;
    field.dispatchEvent(new Event("input", { bubbles: true }));
    field.focus();
  };
  return html`
    <form class="panel relabel" aria-label="This should have been" onSubmit=${submit}>
      <h2>This should have been …</h2>
      <div class="ends">
        <${End} name="from step" at=${0} ...${{ span, setSpan, most: episode.steps }} />
        <${End} name="up to step" at=${1} ...${{ span, setSpan, most: episode.steps }} />
        <p class="small">
          ${covered.length} decisions: ${[...new Set(covered.map((one) => one.executed.text))].join(", ") || "none"}
        </p>
      </div>
      <${Words} robot=${episode.account.robot} fill=${fill} />
      <datalist id="bank">${bank.map((text) => html`<option value=${text} />`)}</datalist>
      ${proposed.length > 0 &&
      html`<p class="suggested">
        ${proposed.map(
          (text) => html`
            <button type="button" onClick=${(event) => fill(event, text)}>${text}</button>
          `,
        )}
      </p>`}
      ${problem && html`<${Aloud} class="notice">${problem}<//>`}
      <div class="actions">
        <button class="primary" disabled=${!covered.length}>Keep</button>
        <button type="button" onClick=${() => send({ kind: "fault" })}>
          The command was right, the hand slipped
        </button>
        <button type="button" onClick=${close}>Cancel <kbd>Esc</kbd></button>
      </div>
      ${!covered.length && html`<p class="small">No decision was taken in it: make it longer.</p>`}
    </form>
  `;
}

/** The field, and what the low level of the episode's robot makes of what stands in it. */
class Words extends Component {
  constructor() {
    super();
    this.state = { text: "", read: null };
  }

  render({ fill }, { text, read }) {
    const { kind, note, reason } = verdict(read?.text === text ? read : null);
    return html`
      <label class="field">
        the right command
        <input
          name="text"
          list="bank"
          required
          maxlength="200"
          autocomplete="off"
          ref=${focus}
          onInput=${(event) => this.type(event.target.value.trim())}
        />
      </label>
      ${text &&
      html`<p class=${`small verdict ${kind}`}>
        ${note}${reason && html`: ${reason}`}
        ${kind !== "known" &&
        (read?.nearest ?? []).map(
          ({ command }) => html`
            <button type="button" onClick=${(event) => fill(event, command)}>${command}</button>
          `,
        )}
      </p>`}
    `;
  }

  type(text) {
    this.setState({ text });
    clearTimeout(this.pause);
    if (text) this.pause = setTimeout(() => this.read(text), PAUSE_MS);
  }

  async read(text) {
    const asked = `phrase?anywhere=true&text=${encodeURIComponent(text)}`;
    const read = await get(`robots/${this.props.robot}/${asked}`).catch(({ message }) => ({
      text,
      unknown: message,
    }));
    if (this.state.text === text) this.setState({ read });
  }
}

/** Once, when the form opens: who selected a stretch goes on typing. */
function focus(field) {
  if (!field || field.dataset.met) return;
  field.dataset.met = "yes";
  field.focus({ preventScroll: true });
}

function End({ name, at, span, setSpan, most }) {
  const change = (event) => {
    const value = Math.min(most, Math.max(0, Number(event.target.value) || 0));
    const ends = at ? [Math.min(span[0], value - 1), value] : [value, Math.max(span[1], value + 1)];
    if (ends[0] >= 0 && ends[1] <= most) setSpan(ends);
  };
  return html`
    <label class="field">
      ${name}
      <input type="number" min="0" max=${most} value=${span[at]} onChange=${change} />
    </label>
  `;
}

/** What the high level itself considered in the stretch, best first. */
function suggestions(decisions) {
  const scores = new Map();
  for (const { proposed, executed } of decisions) {
    for (const { goal, score } of proposed) {
      if (goal.text === executed.text) continue;
      scores.set(goal.text, (scores.get(goal.text) ?? 0) + score);
    }
  }
  const ranked = [...scores].sort(([, one], [, other]) => other - one);
  return ranked.slice(0, SUGGESTED).map(([text]) => text);
}

/** Say something about this episode; what comes back was kept. */
export function say({ account }, body) {
  const { id, robot } = account;
  return post(`robots/${robot}/corrections`, {
    episode: id,
    author: person.id,
    id: newId(),
    ...body,
  });
}

export const takeBack = (episode, id) => say(episode, { kind: "retract", target: id });
