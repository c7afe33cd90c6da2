// What the figures share: where they are from, a table of cells, a slider, and words where nothing
// was measured.
import { html } from "./html.js";

export const Source = ({ report }) => html`
  <p class="small">
    Measured: <code>${report.command}</code>, ${report.date}, at ${report.site}.
  </p>
`;

export const Missing = ({ text }) => html`<p class="notice">${text ?? "…"}</p>`;

export function Slider({ label, value, min, max, step, shown, change }) {
  return html`
    <label>
      <span>${label} <b>${shown}</b></span>
      <input type="range" aria-valuetext=${shown} ...${{ min, max, step, value }}
        onInput=${(event) => change(Number(event.target.value))} />
    </label>
  `;
}

export function Tabs({ names, chosen, choose, label }) {
  return html`
    <div class="tabs" role="group" aria-label=${label}>
      ${names.map(
        (name) => html`
          <button type="button" aria-pressed=${name === chosen} onClick=${() => choose(name)}>${name}</button>
        `,
      )}
    </div>
  `;
}

export const share = ({ success, n, interval: [low, high] }) =>
  `${success.toFixed(2)} (${low.toFixed(2)} to ${high.toFixed(2)}), n = ${n}`;

/** A row of cells as a curve with its intervals; null where nothing was measured. */
export const banded = (cells) => ({
  y: cells.map((cell) => cell?.success ?? null),
  low: cells.map((cell) => cell?.interval[0] ?? null),
  high: cells.map((cell) => cell?.interval[1] ?? null),
});

const figures = (cell) => (cell ? `${share(cell)}; ${Math.round(cell.decisions)} queries` : "–");

/** The figures of one high level. first: what names the rows; rows: [name, cells], by column. */
export const Cells = ({ high, label, first, columns, rows }) => html`
  <div class="scroll" tabindex="0" role="region" aria-label=${label}>
    <table>
      <caption>π_HL ${high}: success with 95 % intervals, and queries an episode</caption>
      <thead>
        <tr>
          ${[first, ...columns].map((name) => html`<th scope="col">${name}</th>`)}
        </tr>
      </thead>
      <tbody>
        ${rows.map(
          ([name, cells]) => html`
            <tr>
              <th scope="row">${name}</th>
              ${cells.map((cell) => html`<td>${figures(cell)}</td>`)}
            </tr>
          `,
        )}
      </tbody>
    </table>
  </div>
`;
