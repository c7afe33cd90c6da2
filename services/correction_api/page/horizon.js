// Compounding error: success as prompts take more skills, beside (1-ε)^T.
import { Curves, Legend } from "./curves.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { Missing, share, Slider, Source, Tabs } from "./measured.js";

const own = { epsilon: 0.05, horizon: 10, task: null };
const REACH = 20;
const COLOURS = ["--policy", "--person"];

export function Horizon({ report, missing, touch }) {
  const set = (name) => (value) => {
    own[name] = value;
    touch();
  };
  const tasks = Object.keys(report?.figures ?? {});
  const task = tasks.includes(own.task) ? own.task : tasks[0];
  const reckoned = (1 - own.epsilon) ** own.horizon;
  const { x, curves } = lines(report?.figures[task]);
  return html`
    <section class="panel" aria-label="Compounding error against horizon">
      <h2>Compounding error against horizon</h2>
      <p class="lead">
        If each of T calls of a skill had to succeed at the first try, with a share ε that fails,
        success would be (1 − ε)^T. A hierarchy may call a skill again, so that what is measured
        lies above it; where errors come together it lies below.
      </p>
      ${report ? html`<${Source} report=${report} />` : html`<${Missing} text=${missing} />`}
      ${tasks.length > 1 &&
      html`<${Tabs} label="Task" names=${tasks} chosen=${task} choose=${set("task")} />`}
      <${Legend} curves=${curves} />
      <${Curves} label="Success against the number of skills" height=${280}
        ...${{ x, curves, top: 1, percent: true, xLabel: "T, skills that the prompt takes" }}
        marks=${[{ x: own.horizon, colour: "--soft" }]} />
      <div class="sliders">
        <${Slider} label="your ε" min="0" max="0.3" step="0.005" value=${own.epsilon}
          shown=${own.epsilon.toFixed(3)} change=${set("epsilon")} />
        <${Slider} label="your horizon T" min="1" max=${REACH} step="1" value=${own.horizon}
          shown=${`${own.horizon} skills`} change=${set("horizon")} />
      </div>
      <${Aloud} class="reckoned" quiet>
        (1 − ${own.epsilon.toFixed(3)})^${own.horizon} = ${(100 * reckoned).toFixed(1)} %
        <span class="small"> reckoned, not measured; to reach 90 % at this T, ε may be at most ${(1 - 0.9 ** (1 / own.horizon)).toFixed(3)}</span>
      <//>
      ${task && html`<${Table} by=${report.figures[task]} task=${task} />`}
    </section>
  `;
}

function lines(figures) {
  const x = Array.from({ length: REACH }, (_, at) => at + 1);
  const curves = Object.entries(figures ?? {}).flatMap(([high, { epsilon, lengths }], at) => {
    const value = (read) => x.map((length) => (lengths[length] ? read(lengths[length]) : null));
    const colour = COLOURS[at % COLOURS.length];
    return [
      {
        label: `π_HL: ${high}, measured`,
        colour,
        y: value((row) => row.success),
        low: value((row) => row.interval[0]),
        high: value((row) => row.interval[1]),
      },
      {
        label: `(1 − ε)^T, ε = ${epsilon.value.toFixed(3)}`,
        colour,
        dashed: true,
        y: x.map((length) => (1 - epsilon.value) ** length),
      },
    ];
  });
  curves.push({
    label: "yours",
    colour: "--warn",
    dashed: true,
    y: x.map((length) => (1 - own.epsilon) ** length),
  });
  return { x, curves };
}

function Table({ by, task }) {
  const rows = Object.entries(by).flatMap(([high, { lengths }]) =>
    Object.entries(lengths).map(([length, row]) => ({ high, length, row })),
  );
  return html`
    <div class="scroll" tabindex="0" role="region" aria-label="Table of the horizon">
      <table>
        <caption>${task}: success by length, with 95 % intervals</caption>
        <thead>
          <tr>
            <th scope="col">π_HL</th>
            <th scope="col" class="number">T</th>
            <th scope="col">success</th>
            <th scope="col">(1 − ε)^T</th>
          </tr>
        </thead>
        <tbody>
          ${rows.map(
            ({ high, length, row }) => html`
              <tr>
                <th scope="row">${high}</th>
                <td class="number">${length}</td>
                <td>${share(row)}</td>
                <td>${row.expected.value.toFixed(2)}</td>
              </tr>
            `,
          )}
        </tbody>
      </table>
    </div>
  `;
}
