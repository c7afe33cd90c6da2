// What is told beside the timeline: the episode, and the decision at the cursor.
import { isPolicy, STEPS_A_SECOND } from "./account.js";
import { html } from "./html.js";
import { when } from "./shell.js";
import { Still } from "./stills.js";

const CHOICES = {
  best: "the best proposal",
  objection: "the hand objected to what was proposed before it",
  smoothed: "the best in the mean of the last looks",
  hysteresis: "no other was better by the margin",
  dwell: "it had not been in force for long enough",
};

const MARKS = { success: "✓", timeout: "✗", aborted: "–" };

export const Outcome = ({ outcome, steps }) => html`
  <span class=${`outcome ${outcome}`} data-mark=${MARKS[outcome]}>${outcome}</span>
  <span class="small">
    ${" "}after ${(steps / STEPS_A_SECOND).toFixed(1)} s, ${steps} control steps
  </span>
`;

export function Title({ id, robot, episode }) {
  return html`
    <div class="title">
      <p class="small">
        <a href="episodes.html">Episodes</a> · ${robot} · <code>${id}</code>
        ${episode && html` · ${when(episode.ended_ns)} · version ${episode.version} · ${episode.site}`}
      </p>
      <h2>${episode ? episode.prompt : "An episode that is not over yet"}</h2>
      ${episode &&
      html`<p><${Outcome} ...${episode} /></p>`}
    </div>
  `;
}

/** name: of the episode, under which its pictures are. */
export function Moment({ name, episode, at }) {
  const person = !isPolicy(at.chosen_by);
  const told = episode.segments.find(
    ({ by, from, to }) => !isPolicy(by) && from <= at.step && at.step < to,
  );
  return html`
    <section class="panel moment" aria-label="Decision at the cursor">
      <div class="stills">
        ${["angle", "top"].map(
          (camera) => html`<${Still} key=${camera} episode=${name} decision=${at.id} camera=${camera} />`,
        )}
      </div>
      <div class="facts-of">
        <p class="small">
          decision ${at.index} · step ${at.step} · ${(at.step / STEPS_A_SECOND).toFixed(1)} s ·${" "}
          asked because of ${at.asked ?? "a reason that was not told"}
        </p>
        <p class=${person ? "caption-of person" : "caption-of"}>
          <q>${at.executed.text}</q>
          <span>${person ? "✎ a person's word" : `policy ${at.chosen_by}, ${CHOICES[at.choice] ?? "in force"}`}</span>
        </p>
        ${told &&
        told.text !== at.executed.text &&
        html`<p class="caption-of person">
          <q>${told.text}</q><span>✎ what a person said instead, in force at once</span>
        </p>`}
        <ol class="proposals" aria-label="Proposals">
          ${at.proposed.slice(0, 5).map(
            ({ goal, score }) => html`
              <li>
                <span>${goal.text}</span>
                <meter min="0" max="1" value=${score} aria-label=${goal.text} />
                <b>${score.toFixed(2)}</b>
              </li>
            `,
          )}
        </ol>
        <p class="small">
          entropy ${at.entropy.toFixed(2)} nats
          ${at.help && html` · <span class="chip warn">? asked for help: ${at.help.reason}</span>`}
        </p>
      </div>
    </section>
  `;
}
