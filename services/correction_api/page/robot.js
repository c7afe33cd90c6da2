// One robot: what it sees, what it does and who chose that, and everything that one can say to it.
import { Component, html } from "./html.js";
import { Picture } from "./pictures.js";
import { say } from "./say.js";
import { callOf, state, touch } from "./store.js";

const SHOWN_HISTORY = 5;
const HOLDS = [
  ["", "until released"],
  ["100", "for 2 s"],
  ["250", "for 5 s"],
];

export class Robot extends Component {
  constructor() {
    super();
    this.state = { text: "", hold: "", begun: null };
  }

  render({ robot, turn }, { text, hold }) {
    const focused = state.focused === robot.robot;
    return html`
      <article
        class=${`robot ${robot.presence} ${robot.by ?? ""} ${focused ? "focused" : ""}`}
        data-robot=${robot.robot}
        onPointerDown=${() => focus(robot.robot)}
        onFocusIn=${() => focus(robot.robot)}
      >
        <${Title} robot=${robot} />
        <div class="pictures">
          <${Picture} key=${robot.robot} robot=${robot.robot} camera="angle" turn=${turn} />
          <${Picture} key=${robot.robot} robot=${robot.robot} camera="top" turn=${turn} />
          <${Caption} robot=${robot} />
        </div>
        <${Proposals} robot=${robot} />
        <form class="words" onSubmit=${(event) => this.send(event)}>
          <input
            type="text"
            name="words"
            maxlength="200"
            autocomplete="off"
            list=${`known-${robot.robot}`}
            placeholder="or say it in your own words"
            aria-label=${`Command for ${robot.robot} in your own words`}
            value=${text}
            onInput=${(event) => this.type(event.target.value)}
          />
          <select
            aria-label="How long it holds"
            value=${hold}
            onChange=${(event) => this.setState({ hold: event.target.value })}
          >
            ${HOLDS.map(([steps, label]) => html`<option value=${steps}>${label}</option>`)}
          </select>
          <button class="say" disabled=${!text.trim()}>Say</button>
        </form>
        <datalist id=${`known-${robot.robot}`}>
          ${known(robot).map((phrase) => html`<option value=${phrase} />`)}
        </datalist>
        <${Verdicts} robot=${robot} />
        <${Status} said=${state.said[robot.robot]} />
        <${History} views=${state.corrections[robot.robot] ?? []} />
      </article>
    `;
  }

  type(text) {
    this.setState({ text, begun: this.state.text ? this.state.begun : Date.now() });
  }

  send(event) {
    event.preventDefault();
    const { text, hold, begun } = this.state;
    if (!text.trim()) return;
    const words = { kind: "override", text, ...(hold && { hold_steps: Number(hold) }) };
    say(this.props.robot.robot, words, begun ?? Date.now());
    this.setState({ text: "", begun: null });
  }
}

function focus(robot) {
  if (state.focused === robot) return;
  state.focused = robot;
  touch();
}

const known = (robot) =>
  state.learner?.policy?.bank ?? robot.decision?.proposed.map(({ goal }) => goal.text) ?? [];

function Title({ robot }) {
  const doing = robot.presence === "online" ? robot.state : robot.presence;
  const since = robot.presence === "online" ? "" : ` for ${Math.round(robot.age_s)} s`;
  return html`
    <header>
      <h2>${robot.robot}</h2>
      <span class=${`doing ${doing}`}>${doing}${since}</span>
      <${Doubt} call=${callOf(robot.robot)} />
      <span class="facts">
        episode ${robot.number} · step <b>${robot.step}</b> · policy ${robot.version}
      </span>
      <p class="prompt">${robot.prompt ?? "between two episodes"}</p>
    </header>
  `;
}

function Doubt({ call }) {
  if (!call) return null;
  const why = call.reason === "stuck" ? "stuck" : `in doubt ${percent(call.doubt)}`;
  const waits = call.waits_s ? `, waits ${Math.ceil(call.waits_s)} s` : "";
  return html`<span class="doing doubt">${why}${waits}</span>`;
}

function Caption({ robot }) {
  if (!robot.command) return html`<p class="caption none">no command in force</p>`;
  const who = robot.by === "policy" ? `policy ${robot.chosen_by}` : (robot.author ?? "a person");
  return html`
    <p class="caption">
      <q>${robot.command.text}</q>
      <span class="who">${robot.by === "policy" ? "chosen by" : "told by"} ${who}</span>
    </p>
  `;
}

function Proposals({ robot }) {
  const scores = new Map(
    (robot.decision?.proposed ?? []).map(({ goal, score }) => [goal.text, score]),
  );
  const slots = state.slots[robot.robot] ?? [];
  const best = robot.decision?.proposed[0]?.goal.text;
  return html`
    <div class="proposals" role="group" aria-label="What the policy considers">
      ${slots.map((text, at) => {
        const score = scores.get(text) ?? 0;
        const marks = [
          text === robot.command?.text ? "in-force" : "",
          text === best ? "best" : "",
        ].join(" ");
        return html`
          <button
            key=${text}
            class=${`proposal ${marks}`}
            style=${{ "--score": score }}
            aria-keyshortcuts=${String(at + 1)}
            title="Say this until released"
            onClick=${() => say(robot.robot, { kind: "override", text })}
          >
            <kbd>${at + 1}</kbd><span>${text}</span><data value=${score}>${percent(score)}</data>
          </button>
        `;
      })}
    </div>
  `;
}

const percent = (score) => (score < 0.005 ? "·" : `${Math.round(100 * score)} %`);

function Verdicts({ robot }) {
  const held = robot.by === "person";
  const tell = (kind) => () => say(robot.robot, { kind });
  const paused = robot.state === "paused";
  return html`
    <div class="verdicts">
      <button onClick=${tell("approve")} disabled=${!robot.decision} aria-keyshortcuts="y">
        <kbd>y</kbd>That is right
      </button>
      <button onClick=${tell("release")} disabled=${!held} aria-keyshortcuts="r">
        <kbd>r</kbd>Release
      </button>
      ${paused
        ? html`<button class="resume" onClick=${tell("resume")}>Resume</button>`
        : html`<button class="pause" onClick=${tell("pause")} aria-keyshortcuts="Escape">
            <kbd>Esc</kbd>Pause
          </button>`}
    </div>
  `;
}

/** What became of what was said here last. */
function Status({ said }) {
  const [mark, text] = said ? outcome(said) : ["", ""];
  return html`<p class=${`status ${mark}`} role="status" aria-live="polite">${text}</p>`;
}

function outcome({ words, status, view, reason }) {
  const what = words.text ? `“${words.text}”` : words.kind;
  const phrase = view?.phrase && !view.phrase.known ? " (new to the policy)" : "";
  switch (status) {
    case "sending":
      return ["pending", `${what}: sending …`];
    case "pending":
      return ["pending", `${what}: kept, waiting for the robot …`];
    case "kept":
      return ["in-force", `${what}: kept for the learner`];
    case "in force":
      return ["in-force", `${what}: in force since step ${view.receipt.step}${phrase}`];
    default:
      return ["refused", `${what}: ${status} because ${reason ?? view?.reason ?? "…"}`];
  }
}

function History({ views }) {
  return html`
    <ol class="history" aria-label="Said before">
      ${views.slice(0, SHOWN_HISTORY).map(
        ({ correction, status, receipt }) => html`
          <li key=${correction.id} class=${status.replace(" ", "-")}>
            <time>${clock(correction.created_ns)}</time>
            <b>${correction.author}</b>
            <span>${correction.goal ? `“${correction.goal.text}”` : correction.kind}</span>
            <em>${receipt?.accepted ? `step ${receipt.step}` : status}</em>
          </li>
        `,
      )}
    </ol>
  `;
}

const clock = (ns) => new Date(ns / 1e6).toLocaleTimeString([], { hour12: false });
