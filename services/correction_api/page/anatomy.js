// The anatomy of a rollout: why the high level was asked, how long commands then held, and how soon
// a person was obeyed; beside the player, and of the newest episode as a figure.
import { anatomy, assemble, delays, median, recall, STEPS_A_SECOND } from "./account.js";
import { get } from "./api.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { Outcome } from "./moment.js";
import { when } from "./shell.js";
import { GLYPHS } from "./timeline.js";
import { Zoom } from "./zoom.js";

export const Anatomy = (episode) => html`
  <section class="panel" aria-label="Anatomy of the rollout">
    <h2>Anatomy of the rollout</h2>
    <${Counted} ...${episode} />
  </section>
`;

function Counted({ decisions: all, steps, said }) {
  const late = delays(said);
  const ms = median(late.map((one) => one.ms));
  const reach = median(late.map((one) => one.steps).filter((one) => one !== null));
  return html`
    <div class="scroll" tabindex="0" role="region" aria-label="Table of reasons">
      <table class="narrow">
        <caption>Why π_HL was asked, and what came of it</caption>
        <thead>
          <tr>
            <th scope="col">because of</th>
            <th scope="col" class="number">asked</th>
            <th scope="col" class="number">another command</th>
            <th scope="col" class="number">seconds until asked again</th>
          </tr>
        </thead>
        <tbody>
          ${anatomy(all, steps).map(
            (row) => html`
              <tr>
                <th scope="row"><span class="glyph">${GLYPHS[row.asked]}</span> ${row.asked}</th>
                <td class="number">${row.count}</td>
                <td class="number">${row.changed}</td>
                <td class="number">${(row.steps / row.count / STEPS_A_SECOND).toFixed(2)}</td>
              </tr>
            `,
          )}
        </tbody>
      </table>
    </div>
    <p class="small">
      ${late.length
        ? `${late.length === 1 ? "One override was" : `${late.length} overrides were`} obeyed: ${ms.toFixed(0)} ms after they were said (median)${
            reach === null ? "" : `, ${reach} control steps after what the person saw`
          }.`
        : "No override was obeyed in this episode."}
    </p>
  `;
}

/** The newest episode that has ended, put together; null: none has. The one before stays where there
 *  is no newer one. */
export async function newest(before) {
  const [found] = (await get("episodes?limit=1")).episodes;
  const whole = before && before.decisions.length >= before.account.episode.decisions;
  if (!found) return null;
  if (whole && found.id === before.account.id) return before;
  const [account, decisions] = await Promise.all([
    get(`episodes/${found.id}`),
    recall(found.id).catch(() => []), // The learner is away; the panel says so.
  ]);
  return assemble(account, decisions);
}

/** One episode as a figure: nothing of it can be moved or changed here. null: none has ended;
 *  undefined: that is not known yet. */
export function Rollout({ episode }) {
  return html`
    <section class="panel" aria-label="Anatomy of a rollout">
      <h2>Anatomy of a rollout</h2>
      <p class="lead">
        A slow policy chooses commands, a fast one acts on them fifty times a second: which
        decision was asked why, what was proposed, what was in force, and when a person spoke.
      </p>
      ${episode && html`<${Drawn} episode=${episode} />`}
      ${episode === null &&
      html`<${Aloud} class="notice">
        No episode has ended yet. Let robots work (<code>hld up</code> starts some): the newest one
        that has ended is drawn here.
      <//>`}
    </section>
  `;
}

function Drawn({ episode }) {
  const { account, decisions } = episode;
  const told = account.episode;
  return html`
    <div>
      <h3 class="prompt">${told.prompt}</h3>
      <p><${Outcome} ...${told} /></p>
      <p class="small">
        ${account.robot} · ${when(told.ended_ns)} · version ${told.version} · ${told.site}
      </p>
    </div>
    ${decisions.length
      ? html`
          <${Zoom} episode=${episode} />
          <p class="small">
            Hatched ✎: a person's word. Hollow: π_HL would rather, and it is not in force. In the row
            of doubt, ?: the robot called for help.
          </p>
          <${Counted} ...${episode} />
        `
      : html`<${Aloud} class="notice">
          Its ${told.decisions} decisions are the learner's to tell, and it doesn't now: start it
          (<code>hld learner</code>), or wait a moment.
        <//>`}
    <p><a href=${`episode.html?id=${account.id}`}>The newest episode, decision by decision</a></p>
  `;
}
