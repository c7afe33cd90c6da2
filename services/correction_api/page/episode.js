// The player: one episode, decision by decision; what was said in it, and saying it afterwards.
import { get } from "./api.js";
import { assemble, recall, STEPS_A_SECOND } from "./account.js";
import { Anatomy } from "./anatomy.js";
import { html } from "./html.js";
import { actionOf, keyOf, pressed, shown } from "./keymap.js";
import { Aloud } from "./line.js";
import { Moment, Title } from "./moment.js";
import { PlayerKeys, singleKeys } from "./playerkeys.js";
import { Relabel, takeBack } from "./relabel.js";
import { SaidTable } from "./saidtable.js";
import { every, Notice, page } from "./shell.js";
import { Zoom } from "./zoom.js";

const ID = new URLSearchParams(location.search).get("id") ?? "";
const MS_A_STEP = 1000 / STEPS_A_SECOND;
const REFRESH_S = 5;

const state = {
  episode: null,
  bank: [],
  cursor: 0,
  span: null,
  dragging: false,
  begin: null, // of a stretch that is set by keys
  begunNs: 0, // when somebody began to set it
  playing: false,
  speed: 2,
  notice: "",
  problem: "", // of what was said of a stretch and not kept
  told: "", // that it was
  away: "",
};
let account = null;
let decisions = [];
let zoom = null; // the window over the timeline

const touch = page("episodes.html", view, async () => {
  await load();
  document.addEventListener("keydown", keys);
  every(REFRESH_S, () => !state.dragging && load());
});

async function load() {
  if (!ID) {
    state.notice = "Which one? The list of episodes leads here.";
    return touch();
  }
  try {
    account = await get(`episodes/${encodeURIComponent(ID)}`);
  } catch (problem) {
    state.notice = problem.message;
    return touch();
  }
  await Promise.all([loadDecisions(), loadBank()]);
  state.episode = assemble(account, decisions);
  touch();
}

async function loadDecisions() {
  try {
    decisions = await recall(ID, decisions);
    state.away = "";
  } catch (problem) {
    state.away = problem.message;
  }
}

async function loadBank() {
  if (state.bank.length) return; // What the low level knows, and not whatever was once said.
  const told = await get(`robots/${account.robot}/commands?anywhere=true`).catch(() => null);
  state.bank = told?.commands ?? [];
}

// -- moving about

/** Where somebody points: they see it. */
function seekStep(step) {
  state.cursor = Math.max(0, decisions.findLastIndex((one) => one.step <= step));
  touch();
}

function seek(index) {
  state.cursor = Math.min(Math.max(0, index), Math.max(0, decisions.length - 1));
  zoom?.show(decisions[state.cursor]?.step ?? 0);
  touch();
}

function play() {
  state.playing = !state.playing;
  if (state.playing && state.cursor >= decisions.length - 1) state.cursor = 0;
  if (state.playing) proceed();
  touch();
}

function proceed() {
  const [now, next] = [decisions[state.cursor], decisions[state.cursor + 1]];
  if (!next) state.playing = false;
  if (!state.playing) return touch();
  setTimeout(() => {
    if (!state.playing) return;
    seek(state.cursor + 1);
    proceed();
  }, Math.max(60, ((next.step - now.step) * MS_A_STEP) / state.speed));
}

// -- a stretch

function select(span, dragging) {
  if (!state.span && span) state.begunNs = nowNs();
  if (dragging) look(span);
  Object.assign(state, { span, dragging, notice: "", problem: "", told: "" });
  touch();
}

/** The cursor goes along with the end that is moved: one sees what one judges. */
function look(span) {
  const moved = span[1] !== (state.span?.[1] ?? span[0]) ? span[1] - 1 : span[0];
  state.cursor = Math.max(0, decisions.findLastIndex(({ step }) => step <= moved));
}

const nowNs = () => Date.now() * 1e6;

function close() {
  Object.assign(state, { span: null, begin: null, dragging: false });
  touch();
}

/** `[` sets where a stretch begins, `]` ends it with the decision at the cursor. */
function bound(end) {
  const at = decisions[state.cursor];
  const steps = state.episode.steps;
  const next = decisions[state.cursor + 1]?.step ?? steps;
  if (end) return select([Math.min(state.begin ?? at.step, next - 1), next], false);
  state.begin = at.step;
  if (!state.span) state.begunNs = nowNs();
  if (state.span) state.span = [at.step, Math.max(state.span[1], next)];
  touch();
}

const ACTS = {
  "player-back": () => seek(state.cursor - 1),
  "player-on": () => seek(state.cursor + 1),
  "player-play": play,
  "player-begin": () => bound(false),
  "player-end": () => bound(true),
  "player-closer": () => zoom?.by(2),
  "player-farther": () => zoom?.by(0.5),
  "player-whole": () => zoom?.by(0),
};

/** Keys that write nothing, and stay what they are. */
const FIXED = {
  ArrowLeft: ACTS["player-back"],
  ArrowRight: ACTS["player-on"],
  Home: () => seek(0),
  End: () => seek(decisions.length),
  Escape: close,
};

function keys(event) {
  const key = pressed(event);
  if (!key || event.defaultPrevented || !state.episode || !decisions.length) return;
  const typing = event.target.closest("input:not([type=checkbox]), select, textarea");
  const pressing = key === " " && event.target.closest("button, a, summary, [type=checkbox]");
  if (pressing || (typing && key !== "Escape")) return;
  const arrow = key.startsWith("Arrow") && !event.target.closest(".timeline");
  const act = FIXED[key] ?? (singleKeys.act && ACTS[actionOf(key)]);
  if (!act || arrow) return;
  event.preventDefault();
  act();
}

async function kept(problem) {
  const [first, end] = state.span;
  state.problem = problem;
  if (!problem) {
    close();
    state.told = `Kept for the learner, of steps ${first} to ${end}.`;
  }
  await load();
}

async function retract(id) {
  await takeBack(state.episode, id).then(
    () => (state.notice = ""),
    (problem) => (state.notice = problem.message),
  );
  await load();
}

// -- what one sees

function view() {
  const { episode } = state;
  if (!episode) {
    return html`<main class="after"><${Notice} text=${state.notice} /></main>`;
  }
  const at = decisions[state.cursor];
  return html`
    <main class="after player">
      <${Title} ...${episode.account} />
      <${Notice} text=${state.notice} />
      ${state.away &&
      html`<${Aloud} class="notice">
        The learner is away, so there are no decisions and pictures: ${state.away}
      <//>`}
      <section class="panel stage" aria-label="Player">
        <${Zoom}
          hold=${(shown) => (zoom = shown)}
          ...${{ episode, cursor: state.cursor, span: state.span, dragging: state.dragging }}
          ...${{ seek: seekStep, select }}
        >
          <${Controls} />
        <//>
      </section>
      <div class=${state.span && !state.dragging ? "judging" : "looking"}>
        ${at && html`<${Moment} name=${ID} ...${{ episode, at }} />`}
        ${state.span &&
        !state.dragging &&
        html`<div class="form" ref=${reveal}>
          <${Relabel}
            ...${{ episode, span: state.span, bank: state.bank, close, said: kept, problem: state.problem }}
            begunNs=${state.begunNs}
            setSpan=${(span) => select(span, false)}
          />
        </div>`}
      </div>
      <${Aloud} class="small">${state.told}<//>
      <${SaidTable} ...${{ episode, retract }} />
      <${Anatomy} ...${episode} />
    </main>
  `;
}

const Kbd = ({ name }) => html`<kbd>${shown(keyOf(name))}</kbd>`;

/** Once, when the form opens: it may begin below what one sees. */
function reveal(form) {
  if (!form || form.dataset.seen) return;
  form.dataset.seen = "yes";
  form.parentElement.scrollIntoView({ block: "nearest" }); // With its pictures, where both fit.
  form.scrollIntoView({ block: "nearest" });
}

function Controls() {
  return html`
    <button onClick=${ACTS["player-back"]} aria-label="Step back">
      <${Kbd} name="player-back" /> back
    </button>
    <button onClick=${play} aria-pressed=${state.playing}>
      <${Kbd} name="player-play" /> ${state.playing ? "pause" : "play"}
    </button>
    <button onClick=${ACTS["player-on"]} aria-label="Step on">
      <${Kbd} name="player-on" /> on
    </button>
    <label class="small">
      speed${" "}
      <select onChange=${(event) => (state.speed = Number(event.target.value))}>
        ${[1, 2, 4, 8].map(
          (one) => html`<option value=${one} selected=${one === state.speed}>${one} ×</option>`,
        )}
      </select>
    </label>
    <button onClick=${ACTS["player-begin"]}><${Kbd} name="player-begin" /> begin here</button>
    <button onClick=${ACTS["player-end"]}><${Kbd} name="player-end" /> end here</button>
    <p class="small">
      ${state.begin !== null && !state.span
        ? `a stretch begins at step ${state.begin}; ${shown(keyOf("player-end"))} ends it`
        : "Drag over the timeline to say what a stretch should have been."}
    </p>
    <${PlayerKeys} touch=${touch} />
  `;
}
