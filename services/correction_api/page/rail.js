// All robots at a glance; a click, a finger or a key puts one into focus.
import { html } from "./html.js";
import { keyOf, shown } from "./keymap.js";
import { Picture } from "./pictures.js";
import { author, callOf, look, state } from "./store.js";
import { doing, doubt } from "./words.js";

export function Rail({ robots, turn }) {
  if (robots.length < 2) return null;
  const size = robots.length > 8 ? "many crowd" : robots.length > 4 ? "many" : "few";
  return html`
    <section class=${`rail ${size}`} aria-label="All robots">
      ${robots.map(
        (name, at) =>
          html`<${Tile} key=${name} robot=${state.robots[name]} number=${at + 1} turn=${turn} />`,
      )}
    </section>
  `;
}

function Tile({ robot, number, turn }) {
  const name = robot.robot;
  const call = callOf(name);
  const mark = robot.presence === "online" ? robot.state : robot.presence;
  const frozen = robot.state === "paused" ? "frozen" : "";
  return html`
    <button
      class=${`tile ${robot.presence} ${robot.by ?? ""} ${frozen} ${call ? "asks" : ""}`}
      data-tile=${name}
      aria-pressed=${String(state.focused === name)}
      onClick=${() => look(name)}
    >
      <span class="view">
        <${Picture} key=${name} robot=${name} camera="angle" rate="slow" turn=${turn} />
      </span>
      <span class="about">
        <span class="name">
          <b>${name}</b>
          ${number < 10 && html`<kbd aria-hidden="true">${shown(keyOf("go"))} ${number}</kbd>`}
        </span>
        <span class="marks">
          ${call && html`<span class="doing doubt">? ${doubt(call)}</span>`}
          ${(!call || frozen) && html`<span class=${`doing ${mark}`}>${doing(robot)}</span>`}
          ${robot.by === "person" && html`<i title=${`told by ${who(robot)}`}>✎ ${who(robot)}</i>`}
        </span>
        <span class="command">${robot.command?.text ?? "no command"}</span>
      </span>
    </button>
  `;
}

/** Whose word the robot carries out. */
const who = (robot) => (robot.author === author() ? "you" : (robot.author ?? "a person"));
