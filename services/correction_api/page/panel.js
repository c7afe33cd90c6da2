// What one can say to the robot in focus.
import { ACTIONS, approve, carryOn, endorse, freeze, release, slip, takeBack } from "./actions.js";
import { html } from "./html.js";
import { aria, keyOf, shown } from "./keymap.js";
import { Line } from "./line.js";
import { Palette } from "./palette.js";
import { taken } from "./places.js";
import { Said } from "./said.js";
import { panelParts } from "./slots.js";
import { state } from "./store.js";
import { percent } from "./words.js";

export function Panel({ robot }) {
  return html`
    <section class="panel" aria-label=${`Correct ${robot.robot}`}>
      <${Palette} key=${robot.robot} robot=${robot} />
      <${Proposals} robot=${robot} />
      <div class="hand">
        <${Verdicts} robot=${robot} />
        <${Line} hushed=${state.asking} />
      </div>
      <${Said} robot=${robot} />
    </section>
  `;
}

function Proposals({ robot }) {
  const proposed = robot.decision?.proposed ?? [];
  const scores = new Map(proposed.map(({ goal, score }) => [goal.text, score]));
  const best = proposed[0]?.goal.text;
  const texts = taken(state.places[robot.robot]);
  return html`
    <section class="proposals" aria-label="What π_HL would rather">
      <h3>π_HL would rather</h3>
      ${!texts.length && html`<p class="none">No decision in this episode yet.</p>`}
      ${texts.map((text, at) => {
        const marks = {
          text,
          at,
          score: scores.get(text) ?? 0,
          best: text === best,
          inForce: text === robot.command?.text,
        };
        return html`<${Proposal} key=${at} ...${marks} />`;
      })}
    </section>
  `;
}

function Proposal({ text, at, score, best, inForce }) {
  const action = `propose-${at + 1}`;
  return html`
    <button
      class=${`proposal ${best ? "best" : ""} ${inForce ? "in-force" : ""}`}
      style=${{ "--score": score }}
      aria-keyshortcuts=${aria(action)}
      onClick=${ACTIONS[action].down}
    >
      <kbd aria-hidden="true">${shown(keyOf(action))}</kbd>
      <span>${text ?? "no proposal"}</span>
      ${inForce && html`<small>in force</small>`}
      ${text !== null && html`<data value=${score}>${percent(score)}</data>`}
    </button>
  `;
}

function Verdicts({ robot }) {
  const frozen = robot.state === "paused";
  return html`
    <div class="verdicts" role="group" aria-label="What you can do">
      <b class="whom" aria-hidden="true">${robot.robot}</b>
      ${frozen
        ? html`<${Key} name="carry-on" mark="carry-on" act=${() => carryOn(robot)}>Carry on<//>`
        : html`<${Key} name="freeze" mark="freeze" act=${freeze}>Freeze<//>`}
      <${Key} name="approve" act=${() => approve(robot)} off=${!robot.decision}>That is right<//>
      <${Key} name="endorse" act=${() => endorse(robot)} off=${!robot.decision}>Right so far<//>
      <${Key} name="release" act=${() => release(robot)} off=${robot.by !== "person" && !frozen}>
        Release
      <//>
      <${Key} name="slip" act=${() => slip(robot)} off=${!robot.decision}>Hand slipped<//>
      <${Key} name="take-back" act=${() => takeBack()}>Take back<//>
      ${panelParts.map((Part) => html`<${Part} robot=${robot} />`)}
    </div>
  `;
}

function Key({ name, mark, act, off, children }) {
  return html`
    <button class=${mark ?? name} onClick=${act} disabled=${off} aria-keyshortcuts=${aria(name)}>
      <span>${children}</span><kbd aria-hidden="true">${shown(keyOf(name)).replace("Shift ", "⇧")}</kbd>
    </button>
  `;
}
