// Speaking: hold Space (or the button), talk, let go. What two engines agree upon is done at once and
// can be undone; anything else is for the person to choose. Stopping never depends on it.
import { get, postSound } from "./api.js";
import { html } from "./html.js";
import { aria, keyOf, shown } from "./keymap.js";
import { addAction } from "./keys.js";
import { barred, begin, end } from "./microphone.js";
import { place, say } from "./say.js";
import { panelParts } from "./slots.js";
import { state, tell, touch } from "./store.js";

const TAP_MS = 250; // Shorter is a slip of the finger, or a press of the button in focus.
const UNDO_MS = 5_000;
const CHOOSE_MS = 20_000;
const TOLD = ["listening", "choosing", "told"]; // what the line that is read out says of it

// phase: idle, opening, listening, recognising, choosing, done or told; robot: whom it is about.
const speaking = { phase: "idle", robot: null };
let service = null; // what the server says that it recognises
let limit = null;
let meter = null;

/** Speech by the keyboard; before the other keys, since a choice has the digits first. */
export function listenForSpeech() {
  addAction("speak", " ", { label: "Hold and talk", down: () => press(state.focused), up });
  panelParts.push(Speak);
  document.addEventListener("keydown", down, true);
  window.addEventListener("blur", cancel);
  ask();
}

/** Begin to listen for what is said to a robot. */
export async function press(robot) {
  if (!state.robots[robot]) return;
  if (["opening", "listening", "recognising"].includes(speaking.phase) || problem()) return;
  show("opening", { robot, looked: { decision: null, ...place(robot) }, begunMs: Date.now() });
  const { begunMs } = speaking;
  try {
    await begin((level) => meter?.style.setProperty("--level", level));
  } catch (error) {
    show("told", { robot, text: error.message });
    return;
  }
  if (speaking.phase !== "opening" || speaking.begunMs !== begunMs) {
    await end();
    return;
  }
  show("listening");
  limit = setTimeout(release, 1000 * (service.max_s - 0.5));
}

/** End of what was said: recognise it. A short tap does nothing. */
export async function release() {
  clearTimeout(limit);
  if (speaking.phase === "opening") show("idle");
  if (speaking.phase !== "listening") return;
  if (Date.now() - speaking.begunMs < TAP_MS) {
    cancel();
    return;
  }
  show("recognising");
  try {
    const sound = await end();
    const found = sound && (await postSound(`speech?robot=${speaking.robot}`, service.media_type, sound));
    await answer(found);
  } catch (error) {
    show("told", { text: error.message });
  }
}

/** Hear no more, and do nothing by what was heard so far. */
export function cancel() {
  clearTimeout(limit);
  if (!["opening", "listening"].includes(speaking.phase)) return;
  show("idle");
  end();
}

async function answer(found) {
  const heard = found?.heard.filter(({ text }) => text) ?? [];
  if (found?.agreed) await take(found.agreed, heard);
  else if (found?.choices.length) show("choosing", { heard, choices: found.choices }, CHOOSE_MS);
  else show("told", { text: `No command was recognised${quoted(heard)}. Say it again, or type it.` });
}

/** Say a command, under the words that were heard for it. */
async function take(text, heard) {
  const { robot, looked, begunMs } = speaking;
  const words = { kind: "override", text, heard: saidFor(text, heard), ...looked };
  show("done", { text, id: null });
  const id = await say(robot, words, begunMs);
  if (speaking.phase === "done" && speaking.begunMs === begunMs) show("done", { id }, UNDO_MS);
}

const saidFor = (text, heard) => (heard.find(({ command }) => command === text) ?? heard[0]).text;

function undo() {
  const { robot, id } = speaking;
  show("idle");
  say(robot, { kind: "retract", target: id });
}

/** Show a phase, and go back to idle after a while. */
function show(phase, more = {}, forMs = null) {
  clearTimeout(speaking.timer);
  Object.assign(speaking, { phase, ...more });
  if (forMs) speaking.timer = setTimeout(() => show("idle"), forMs);
  if (TOLD.includes(phase)) tell(WORDS[phase](speaking));
  touch();
}

const problem = () => barred() ?? (service ? service.reason || null : "Speech is not ready yet.");

async function ask() {
  try {
    service = await get("speech");
  } catch (error) {
    service = { reason: `Speech is not there: ${error.message}` };
  }
  touch();
}

const rests = (event) =>
  state.locked ||
  !state.keys ||
  !state.robots[state.focused] ||
  event.ctrlKey ||
  event.metaKey ||
  event.altKey ||
  event.target.matches?.("input, select, textarea, summary");

/** A digit means nothing while it is open what it will mean: a choice, or a proposal of the policy. */
function down(event) {
  if (event.key === "Escape") dismiss();
  else if (rests(event)) return;
  else if (speaking.phase === "recognising" && /^([1-9]|Enter)$/.test(event.key)) swallow(event);
  else if (speaking.phase === "choosing" && choose(event.key)) swallow(event);
}

/** The button in focus keeps a tap of Space for itself, and no more than a tap. */
function up(event) {
  if (speaking.phase === "listening" && Date.now() - speaking.begunMs >= TAP_MS) event?.preventDefault();
  if (["opening", "listening"].includes(speaking.phase)) release();
}

/** Nothing is done by what was said. The key goes on to the robot, which stands still by it. */
function dismiss() {
  cancel();
  if (["choosing", "done", "told"].includes(speaking.phase)) show("idle");
}

function choose(key) {
  const { choices, heard } = speaking;
  const at = key === "Enter" && choices.length === 1 ? 0 : Number(key) - 1;
  if (!choices[at]) return false;
  take(choices[at], heard);
  return true;
}

function swallow(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}

const quoted = (heard) =>
  heard.length ? `: ${heard.map(({ engine, text }) => `“${text}” (${engine})`).join(", ")}` : "";

const WORDS = {
  opening: () => "Opening the microphone …",
  listening: () => "Listening … let go when you have said it",
  recognising: () => "Recognising …",
  choosing: ({ heard }) => `Heard${quoted(heard)}. Which one?`,
  done: ({ text }) => `Heard “${text}”`,
  told: ({ text }) => text,
};

export function Speak({ robot }) {
  const why = problem();
  const { robot: whom, phase: now } = speaking;
  const phase = whom === robot.robot ? now : "idle";
  const on = ["opening", "listening"].includes(phase);
  return html`
    <div class=${`speak ${phase}`}>
      <button
        class="talk"
        type="button"
        aria-keyshortcuts=${aria("speak")}
        aria-pressed=${on}
        aria-describedby=${`speech-${robot.robot}`}
        disabled=${Boolean(why)}
        onPointerDown=${(event) => hold(event, robot.robot)}
        onPointerUp=${release}
        onPointerCancel=${cancel}
      >
        <span>Hold and talk</span><kbd aria-hidden="true">${shown(keyOf("speak"))}</kbd>
        <span class="level" ref=${(element) => on && element && (meter = element)} />
      </button>
      <${Heard} id=${`speech-${robot.robot}`} why=${why} phase=${phase} />
      ${phase === "choosing" && html`<${Choices} choices=${speaking.choices} />`}
      ${phase === "done" && speaking.id && html`<button class="undo" onClick=${undo}>Undo</button>`}
    </div>
  `;
}

/** What goes on; the line that is read out has the rest. A reason is long: whoever asks sees it. */
function Heard({ id, why, phase }) {
  if (!why) return html`<p id=${id} class="heard">${TOLD.includes(phase) ? "" : WORDS[phase]?.(speaking)}</p>`;
  return html`
    <details class="heard">
      <summary>No speech here: why, and what to do</summary>
      <p id=${id}>${why}</p>
    </details>
  `;
}

/** The pointer stays with the button, so that letting go anywhere ends it. */
function hold(event, robot) {
  if (event.button !== 0) return;
  event.currentTarget.setPointerCapture(event.pointerId);
  press(robot);
}

function Choices({ choices }) {
  return html`
    <div class="choices" role="group" aria-label="What was meant">
      ${choices.map(
        (text, at) => html`
          <button key=${text} class="choice" aria-keyshortcuts=${String(at + 1)} onClick=${() => choose(String(at + 1))}>
            <kbd>${at + 1}</kbd><span>${text}</span>
          </button>
        `,
      )}
    </div>
  `;
}
