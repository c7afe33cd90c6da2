// The lecture's figures, fed by what was measured, with sliders to set beside it what one has in mind.
import { newest, Rollout } from "./anatomy.js";
import { get } from "./api.js";
import { Horizon } from "./horizon.js";
import { html } from "./html.js";
import { Replanning } from "./replanning.js";
import { every, page } from "./shell.js";
import { Transitions } from "./transitions.js";

const REFRESH_S = 10;

const state = { reports: {}, missing: {}, episode: undefined };

const touch = page("figures.html", view, async () => {
  await Promise.all([load(), look()]);
  every(REFRESH_S, look);
});

async function load() {
  const { reports } = await get("reports");
  for (const { name, measured, hint } of reports) {
    if (measured) state.reports[name] = await get(`reports/${name}`);
    else state.missing[name] = hint;
  }
  touch();
}

/** Whatever is drawn stays while the service is away. */
async function look() {
  state.episode = await newest(state.episode).catch(() => state.episode);
  touch();
}

function view() {
  const { reports, missing, episode } = state;
  return html`
    <main class="after">
      <${Horizon} report=${reports.horizon} missing=${missing.horizon} touch=${touch} />
      <${Replanning} report=${reports.replanning} missing=${missing.replanning} touch=${touch} />
      <${Transitions} report=${reports.transitions} missing=${missing.transitions} />
      <${Rollout} episode=${episode} />
    </main>
  `;
}
