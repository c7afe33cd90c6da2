// Progress: curves by version, what each round brought, and what people decide about versions.
import { get, Problem } from "./api.js";
import { Curves, Legend } from "./curves.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { Decide, Rulings } from "./rulings.js";
import { every, Notice, page, told, when } from "./shell.js";
import { count } from "./words.js";

const REFRESH_S = 5;
const MARKS = { passed: "✓", refused: "✗", failed: "✗", running: "…" };

const state = { versions: [], policy: null, away: "", notice: "", loaded: false };

const touch = page("progress.html", view, async () => {
  await load();
  every(REFRESH_S, load);
});

async function load() {
  const [progress, policy] = await Promise.allSettled([get("progress"), get("policy")]);
  if (progress.value) state.versions = progress.value.versions;
  if (policy.value) state.policy = policy.value;
  state.away = policy.reason instanceof Problem ? policy.reason.message : "";
  state.notice = progress.reason?.message ?? "";
  state.loaded = true;
  touch();
}

function view() {
  const { policy } = state;
  return html`
    <main class="after grid-2">
      ${state.notice && html`<div class="wide"><${Notice} text=${state.notice} /></div>`}
      ${state.away &&
      html`<${Aloud} class="notice wide">
        The learner is away: rounds and versions are as they were last seen. ${state.away}
      <//>`}
      ${policy && html`<${Brought} rounds=${policy.rounds} />`}
      ${state.versions.length
        ? html`<${Success} /><${Effort} />`
        : state.loaded && html`<p class="lead wide">No version has done anything yet.</p>`}
      ${rows().length > 0 && html`<${Table} />`}
      ${policy &&
      html`<${Decide} policy=${policy} done=${load} />
        <${Rounds} ...${policy} />
        <${Rulings} ...${policy} />`}
    </main>
  `;
}

function Brought({ rounds }) {
  return html`
    <section class="panel wide" aria-label="What rounds brought">
      <h2>What each round brought</h2>
      ${rounds.length === 0 && html`<p class="lead">No round has begun yet.</p>`}
      <ol class="brought">
        ${[...rounds].reverse().map(
          ({ number, state: outcome, brought }) => html`
            <li key=${number} data-round=${number}>
              <span class=${`outcome ${outcome}`} data-mark=${MARKS[outcome]}>round ${number}</span>
              <q>${brought}</q>
            </li>
          `,
        )}
      </ol>
      ${rounds.some(unmeasured) &&
      html`<p class="small">
        Whether robots succeed more often is measured where one asks for it:${" "}
        <code>hld up --oracle --evaluate 60</code> tries each version on 60 evaluation seeds, and with${" "}
        <code>--gate 20</code> (the learner's <code>gate.trials.episodes</code>; as <code>hld up</code>${" "}
        does unless told otherwise) the gate tries each candidate beside the version in force. Then this
        says “14 corrections: 52 % → 71 %, n = 200”.
      </p>`}
    </section>
  `;
}

const unmeasured = ({ state: outcome, trials, parent, made }) => {
  if (outcome === "running" || trials) return false;
  const alone = (number) => state.versions.find((one) => one.number === number)?.alone;
  return !alone(parent) || !alone(made);
};

const places = () => ({
  x: state.versions.map((_, at) => at),
  names: state.versions.map(({ version }) => version),
});
const part = (name, key) => state.versions.map((one) => one[name]?.[key] ?? null);
const banded = (name) => ({ y: part(name, "share"), low: part(name, "low"), high: part(name, "high") });

function Success() {
  const curves = [
    { label: "alone, on evaluation seeds", colour: "--policy", ...banded("alone") },
    { label: "in service, with people", colour: "--person", ...banded("service") },
  ].filter(({ y }) => y.some((value) => value !== null));
  return html`
    <section class="panel" aria-label="Success">
      <h2>Success by version</h2>
      <${Legend} curves=${curves} />
      <${Curves} label="Success by version; the figures are in the table" ...${places()}
        ...${{ curves, top: 1, percent: true, xLabel: "version" }} />
      <p class="small">
        ${state.versions.length > 1 ? "Bands are" : "The line through each point is"} Wilson's
        interval, 95 %.
      </p>
    </section>
  `;
}

const each = (one, figure) => (one.service?.n ? figure(one) / one.service.n : null);

function Effort() {
  const spoken = state.versions.map((one) => each(one, ({ corrections }) => corrections));
  const seconds = state.versions.map((one) => each(one, ({ human_s: spent }) => spent));
  const curves = [
    { label: "corrections an episode", colour: "--person", y: spoken },
    { label: "human seconds an episode", colour: "--warn", dashed: true, dots: true, y: seconds },
  ];
  return html`
    <section class="panel" aria-label="Effort">
      <h2>What people put in</h2>
      <${Legend} curves=${curves} />
      <${Curves} label="Corrections and human seconds an episode; see the table" ...${places()}
        ...${{ curves, xLabel: "version" }} />
      <p class="small">Human seconds: from when somebody began to speak to when it was said.</p>
    </section>
  `;
}

const inForce = (number) =>
  state.policy?.versions.some((one) => one.in_force && one.number === number);

/** The versions that did something, and what is in force, which may have done nothing yet. */
function rows() {
  const known = new Set(state.versions.map(({ number }) => number));
  const fresh = (state.policy?.versions ?? []).filter(
    (one) => one.in_force && !known.has(one.number),
  );
  const nothing = { also: [], alone: null, service: null, corrections: 0, human_s: 0 };
  return [...state.versions, ...fresh.map((one) => ({ ...one, ...nothing }))].sort(
    (one, other) => one.number - other.number,
  );
}

function Table() {
  return html`
    <section class="panel wide" aria-label="Figures by version">
      <div class="scroll" tabindex="0" role="region" aria-label="Table of versions">
        <table>
          <caption>Figures by version, with 95 % intervals</caption>
          <thead>
            <tr>
              <th scope="col">version</th>
              <th scope="col">success alone</th>
              <th scope="col">success in service</th>
              <th scope="col" class="number">corrections</th>
              <th scope="col" class="number">an episode</th>
              <th scope="col" class="number">human seconds</th>
            </tr>
          </thead>
          <tbody>
            ${rows().map(
              (one) => html`
                <tr key=${one.version} data-version=${one.version}>
                  <th scope="row">
                    ${one.version}${" "}
                    ${inForce(one.number) && html`<span class="chip good">in force</span>`}
                    ${one.also.length > 0 && html`${" "}<span class="small">robots call it ${one.also.at(-1)}</span>`}
                  </th>
                  <td>${told(one.alone) ?? "not evaluated"}</td>
                  <td>${told(one.service) ?? "no episode yet"}</td>
                  <td class="number">${one.corrections}</td>
                  <td class="number">${one.service ? (one.corrections / one.service.n).toFixed(1) : "–"}</td>
                  <td class="number">${one.human_s.toFixed(1)}</td>
                </tr>
              `,
            )}
          </tbody>
        </table>
      </div>
    </section>
  `;
}

const change = (compared) =>
  compared ? `${told(compared.before)} → ${told(compared.after)}` : "–";

function Rounds({ rounds, versions }) {
  const name = (number) => versions.find((one) => one.number === number)?.version ?? "–";
  return html`
    <section class="panel wide" aria-label="Rounds and the gate">
      <h2>Rounds and the gate</h2>
      <div class="scroll" tabindex="0" role="region" aria-label="Table of rounds">
        <table>
          <caption>What each round was made from, and what the gate found</caption>
          <thead>
            <tr>
              <th scope="col">round</th>
              <th scope="col">made</th>
              <th scope="col">gate</th>
              <th scope="col">new</th>
              <th scope="col">held-out labels</th>
              <th scope="col">demonstrations</th>
              <th scope="col">paired episodes</th>
              <th scope="col">ended</th>
            </tr>
          </thead>
          <tbody>
            ${rounds.map(
              (one) => html`
                <tr key=${one.number}>
                  <th scope="row">${one.number}</th>
                  <td>${one.made === null ? "–" : name(one.made)}</td>
                  <td>
                    <span class=${`outcome ${one.state}`} data-mark=${MARKS[one.state]}>${one.state}</span>
                    ${one.reason && html`<p class="small">${one.reason}</p>`}
                  </td>
                  <td>${count(one.episodes, "episode")}, ${count(one.corrections, "correction")}</td>
                  <td>
                    ${change(one.held_out)}
                    ${one.unjudged && html`<p class="small">${one.unjudged}</p>`}
                  </td>
                  <td>${change(one.retained)}</td>
                  <td>${change(one.trials)}${one.trials_p === null ? "" : `, p ${probability(one.trials_p)}`}</td>
                  <td>${one.ended_ns ? when(one.ended_ns) : "–"}</td>
                </tr>
              `,
            )}
          </tbody>
        </table>
      </div>
    </section>
  `;
}

const probability = (p) => (p < 0.001 ? "< 0.001" : `= ${p.toFixed(3)}`);
