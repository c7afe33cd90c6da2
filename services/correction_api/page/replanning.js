// How often to ask a high level that takes its time: success against queries, by delay.
import { STEPS_A_SECOND } from "./account.js";
import { Curves, Legend } from "./curves.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { banded, Cells, Missing, Slider, Source } from "./measured.js";

const own = { interval: 20, delay: 0, episode: 480 };
const COLOURS = ["--policy", "--person", "--warn"];

const seconds = (steps) => steps / STEPS_A_SECOND;

export function Replanning({ report, missing, touch }) {
  const highs = Object.entries(report?.figures ?? {});
  return html`
    <section class="panel" aria-label="Replanning interval against delay and cost">
      <h2>Replanning: interval, delay and cost</h2>
      <p class="lead">
        A wrong command lasts until the next look, and each look costs a query. An answer that comes
        late is about a moment that is over.
      </p>
      ${report ? html`<${Source} report=${report} />` : html`<${Missing} text=${missing} />`}
      ${highs.map(([high, swept]) => html`<${Swept} key=${high} ...${{ high, swept }} />`)}
      <h3>With settings of your own</h3>
      <${Own} touch=${touch} />
    </section>
  `;
}

/** swept: by delay, then by interval, both in control steps: success and queries an episode. */
function Swept({ high, swept }) {
  const delays = Object.keys(swept);
  const intervals = [...new Set(delays.flatMap((delay) => Object.keys(swept[delay])))]
    .map(Number)
    .sort((one, other) => one - other);
  const rows = delays.map((delay) => [delay, intervals.map((interval) => swept[delay][interval])]);
  const curves = rows.map(([delay, cells], at) => ({
    label: `answers after ${seconds(delay)} s`,
    colour: COLOURS[at % COLOURS.length],
    ...banded(cells),
  }));
  return html`
    <h3>π_HL: ${high}</h3>
    <${Legend} curves=${curves} />
    <${Curves} label=${`Success of ${high} by replanning interval`} height=${190}
      ...${{ x: intervals.map(seconds), curves, top: 1, percent: true }}
      xLabel="seconds from one query to the next" />
    <${Cells} high=${high} label=${`Intervals and delays for ${high}`} first="answers after"
      columns=${intervals.map((interval) => `asked every ${seconds(interval)} s`)}
      rows=${rows.map(([delay, cells]) => [`${seconds(delay)} s`, cells])} />
  `;
}

function Own({ touch }) {
  const set = (name) => (value) => {
    own[name] = value;
    touch();
  };
  const told = (steps) => seconds(steps).toFixed(2);
  const worst = own.interval + own.delay;
  const mean = own.interval / 2 + own.delay;
  return html`
    <div class="sliders">
      <${Slider} label="asked every" min="5" max="150" step="5" value=${own.interval}
        shown=${`${own.interval} steps, ${told(own.interval)} s`} change=${set("interval")} />
      <${Slider} label="answers after" min="0" max="100" step="5" value=${own.delay}
        shown=${`${own.delay} steps, ${told(own.delay)} s`} change=${set("delay")} />
      <${Slider} label="an episode lasts" min="100" max="3000" step="20" value=${own.episode}
        shown=${`${told(own.episode)} s`} change=${set("episode")} />
    </div>
    <${Aloud} class="reckoned" quiet>
      A command that turns wrong stays in force for ${told(mean)} s on average, at most${" "}
      ${told(worst)} s, at ${Math.ceil(own.episode / own.interval)} queries an episode.
      <span class="small"> Reckoned from interval and delay, not measured.</span>
    <//>
  `;
}
