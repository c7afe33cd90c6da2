// What was said in an episode and about it, as a table; what stands can be taken back.
import { html } from "./html.js";
import { called, count } from "./words.js";

const TAKEN_BACK = ["override", "release", "approve", "relabel", "fault", "edit", "retime", "endorse"];

export function SaidTable({ episode, retract }) {
  const verdicts = episode.said.filter(({ kind }) => kind === "approve" || kind === "pass");
  const told = episode.said.filter((one) => !verdicts.includes(one));
  const approved = verdicts.filter(stands);
  return html`
    <section class="panel" aria-label="What was said">
      <h2>What was said</h2>
      ${told.length > 0 &&
      html`<div class="scroll" tabindex="0" role="region" aria-label="Table of what was said">
        <table class="list">
          <caption>Steps are control steps, 50 a second</caption>
          <thead>
            <tr>
              <th scope="col">kind</th>
              <th scope="col">words</th>
              <th scope="col">by</th>
              <th scope="col">steps</th>
              <th scope="col">state</th>
              <td></td>
            </tr>
          </thead>
          <tbody>
            ${told.map((one) => html`<${Row} key=${one.view.correction.id} ...${{ one, episode, retract }} />`)}
          </tbody>
        </table>
      </div>`}
      <p class="small">
        ${told.length === 0 && "Nobody corrected anything. "}
        ${approved.length > 0 && `${count(approved.length, "decision")} approved or passed.`}
      </p>
    </section>
  `;
}

const stands = ({ retracted, view }) =>
  !retracted && !["refused", "expired"].includes(view.status);

function Row({ one, episode, retract }) {
  const { correction } = one.view;
  return html`
    <tr data-correction=${correction.id} class=${one.retracted ? "gone" : ""}>
      <th scope="row">${called(one.kind)}</th>
      <td class="words">${one.text ?? correction.note ?? about(correction, episode)}</td>
      <td data-label="by">${correction.author}</td>
      <td data-label="steps:">${steps(one, episode.steps)}</td>
      <td class="state">${one.state}</td>
      <td>
        ${stands(one) &&
        TAKEN_BACK.includes(one.kind) &&
        html`<button onClick=${() => retract(correction.id)}>Take back</button>`}
      </td>
    </tr>
  `;
}

/** What an amendment is about, in the words of that. */
function about({ target }, { said }) {
  if (!target) return "–";
  const meant = said.find(({ view }) => view.correction.id === target);
  if (!meant) return "of something said elsewhere";
  return `of “${meant.text ?? called(meant.kind)}”`;
}

/** Whoever spoke after the last step did so at none of them. */
function steps({ span, begun, seen, inForce }, last) {
  if (span) return `${span[0]} to ${span[1]}`;
  if (begun > last) return "after its end";
  const parts = [["began", begun], ["saw", seen], ["in force", inForce]];
  return parts.filter(([, step]) => step !== null).map(([name, step]) => `${name} ${step}`).join(", ") || "–";
}
