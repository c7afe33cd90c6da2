// When to ask the high level again: by interval, by completion, or both.
import { Curves, Legend } from "./curves.js";
import { html } from "./html.js";
import { banded, Cells, Missing, Source } from "./measured.js";

const WAYS = ["interval", "completion", "both"];
const PACES = {
  fast: "answers at once, asked every 0.4 s",
  slow: "answers after 1 s, asked every 2 s",
};
const COLOURS = { fast: "--policy", slow: "--person" };

export function Transitions({ report, missing }) {
  const highs = Object.entries(report?.figures ?? {});
  return html`
    <section class="panel" aria-label="When to go on to the next skill">
      <h2>When to go on to the next skill</h2>
      <p class="lead">
        By interval; when a classifier says that the command is achieved, which it does as soon as
        that is so, unless it errs; or by both, with a timer for commands that nothing comes of.
      </p>
      ${report ? html`<${Source} report=${report} />` : html`<${Missing} text=${missing} />`}
      ${highs.map(([high, by]) => html`<${Measured} key=${high} ...${{ high, by }} />`)}
    </section>
  `;
}

function Measured({ high, by }) {
  const paces = Object.keys(PACES).filter((pace) => by[pace]);
  const rows = paces.map((pace) => [pace, WAYS.map((way) => by[pace][way])]);
  const curves = rows.map(([pace, cells]) => ({
    label: `${pace}: ${PACES[pace]}`,
    colour: COLOURS[pace],
    ...banded(cells),
  }));
  return html`
    <h3>π_HL: ${high}</h3>
    <${Legend} curves=${curves} />
    <${Curves} label=${`Success of ${high} by when it is asked`} height=${190}
      ...${{ x: WAYS.map((_, at) => at), names: WAYS, curves, top: 1, percent: true, apart: true }} />
    <${Cells} high=${high} label=${`Table for ${high}`} first="π_HL is"
      columns=${WAYS.map((way) => `asked by ${way}`)} rows=${rows} />
  `;
}
