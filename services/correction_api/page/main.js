// The page: a live connection, a state, and one function that shows it.
import { get, onRefused } from "./api.js";
import { Focus } from "./focus.js";
import { Help } from "./help.js";
import { html, render } from "./html.js";
import { listen } from "./keys.js";
import { Aloud, Line } from "./line.js";
import { Live } from "./live.js";
import { Lock } from "./lock.js";
import { Overview } from "./overview.js";
import { Panel } from "./panel.js";
import { show } from "./pictures.js";
import { Rail } from "./rail.js";
import { watchLifted, watchOverruled } from "./said.js";
import { settle } from "./say.js";
import { cancel, listenForSpeech } from "./speak.js";
import {
  author,
  focus,
  hear,
  loadHistory,
  loadTally,
  names,
  onChange,
  state,
  tick,
  touch,
} from "./store.js";

const INTRODUCE_MS = 400; // After the last letter of a name.
const TICK_MS = 1000;

let live = null;
let coming = ""; // the name that is told next, or was
let introducing = 0;
const turn = (robot, camera, rate, on) => live.turn(robot, camera, rate, on);

function Page() {
  const robots = names();
  const robot = focus();
  const size = robots.length > 4 ? "many" : robots.length > 1 ? "few" : "one";
  return html`
    <${Overview} />
    <${Outage} />
    <main class=${`desk ${size} ${state.silent ? "quiet" : ""}`}>
      ${robot && html`<${Focus} key=${robot.robot} robot=${robot} turn=${turn} />`}
      ${robot && html`<${Panel} robot=${robot} />`}
      <${Rail} robots=${robots} turn=${turn} />
      ${!robot && html`<div class="empty"><p>No robot has been heard of yet.</p><${Line} hushed=${state.asking} /></div>`}
    </main>
    ${state.asking && html`<${Help} />`}
  `;
}

/** What one sees is old: said once, while the seconds go on. */
function Outage() {
  if (!state.ready || (state.linked && !state.silent)) return null;
  if (!state.silent) return html`<${Aloud} class="banner">No connection …<//>`;
  return html`
    <${Aloud} class="banner">
      Nothing heard from the service${" "}
      <span aria-hidden="true">for ${state.silent} s</span>: what you see is old, and robots may
      move. A freeze is sent again until it is answered.
    <//>
  `;
}

/** Who sits before this page, and which robot they look at: so that others see it. */
function present() {
  state.introduced = author();
  return { author: state.introduced, focus: state.focused };
}

function heard(message) {
  hear(message);
  watchOverruled(message);
  watchLifted(message);
}

/** The name under which others see this page follows the one that is typed. */
function introduce() {
  const name = author();
  if (name === coming || !live) return;
  coming = name;
  clearTimeout(introducing);
  introducing = setTimeout(() => live.look(), INTRODUCE_MS);
}

function linked(yes) {
  state.linked = yes;
  if (yes) Promise.all([loadHistory(), loadTally()]).catch(() => {});
  touch();
}

function quiet(seconds) {
  if (state.silent === seconds) return;
  state.silent = seconds;
  touch();
}

/** Whoever's token is no longer good steers nothing; a new one opens the page anew. */
function lock() {
  state.locked = true;
  live?.end();
  cancel();
  touch();
}

async function start() {
  onRefused(lock);
  onChange(() => {
    introduce();
    render(html`<${state.locked ? Lock : Page} />`, document.body);
  });
  try {
    const { person } = await get("me");
    state.person = person;
    state.name = person ?? state.name;
  } catch {
    // Refused, or not there: then it may come back.
  }
  state.ready = true;
  if (!state.locked) listenForSpeech();
  const take = (message) => [heard, settle].forEach((hear) => hear(message));
  if (!state.locked) live = new Live({ heard: take, seen: show, linked, present, quiet });
  listen();
  setInterval(tick, TICK_MS);
  touch();
}

start();
