// The page: a live connection, a state, and one function that shows it.
import { get, token } from "./api.js";
import { Fleet } from "./fleet.js";
import { html, render } from "./html.js";
import { listen } from "./keys.js";
import { Live } from "./live.js";
import { show } from "./pictures.js";
import { Robot } from "./robot.js";
import { hear, loadHistory, loadTally, onChange, state, touch } from "./store.js";

let live = null;
const turn = (robot, camera, on) => live.turn(robot, camera, on);

function Page() {
  const robots = Object.keys(state.robots).sort();
  return html`
    <${Fleet} />
    ${state.ready && !state.linked && html`<p class="banner" role="alert">No connection …</p>`}
    <main>
      ${robots.map((name) => html`<${Robot} key=${name} robot=${state.robots[name]} turn=${turn} />`)}
      ${!robots.length && html`<p class="empty">No robot has been heard of yet.</p>`}
    </main>
  `;
}

function Lock() {
  const unlock = (event) => {
    event.preventDefault();
    token.set(event.target.elements.token.value);
    location.reload();
  };
  return html`
    <form class="lock" onSubmit=${unlock}>
      <label>Token of this service <input name="token" type="password" /></label>
      <button>Open</button>
    </form>
  `;
}

function linked(yes) {
  state.linked = yes;
  if (yes) Promise.all([loadHistory(), loadTally()]).catch(() => {});
  touch();
}

async function start() {
  onChange(() => render(html`<${state.locked ? Lock : Page} />`, document.body));
  try {
    await get("learner");
  } catch (error) {
    state.locked = error.status === 401;
  }
  state.ready = true;
  if (!state.locked) live = new Live({ heard: hear, seen: show, linked });
  listen();
  touch();
}

start();
