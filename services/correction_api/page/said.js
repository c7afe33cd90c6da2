// What was said about the robot in focus, and where each of it stands.
import { mine, takeBack, takenBack } from "./actions.js";
import { html } from "./html.js";
import { lesson } from "./lineage.js";
import { author, state, tell } from "./store.js";
import { clock, named, namedAmong, overruled, over, standing } from "./words.js";

export function Said({ robot }) {
  const gone = takenBack();
  const waiting = Object.values(state.sending)
    .filter((one) => one.robot === robot.robot)
    .sort((one, other) => other.at - one.at);
  const views = state.corrections[robot.robot] ?? [];
  const resumes = views.filter(
    ({ correction, status }) => correction.kind === "resume" && status === "in force",
  );
  const now = { robot, resumes, me: author() };
  return html`
    <section class="said" aria-label=${`Said about ${robot.robot}`}>
      <h3>Said</h3>
      <ol>
        ${waiting.map((one) => html`<${Unsent} key=${one.id} ...${{ one, views }} />`)}
        ${views.map((view) => html`<${Line} key=${view.correction.id} ...${{ view, views, gone, now }} />`)}
      </ol>
      ${!waiting.length && !views.length && html`<p class="none">Nothing has been said yet.</p>`}
    </section>
  `;
}

function Unsent({ one, views }) {
  return html`
    <li class=${one.status}>
      <span class="what">${namedAmong(one.words, views)}</span>
      <span class="where">${standing(one)}</span>
      <small>you · ${clock(one.at)}</small>
    </li>
  `;
}

function Line({ view, views, gone, now }) {
  const { correction, status } = view;
  const back = gone.has(correction.id);
  const who = correction.author === author() ? "you" : correction.author;
  const { words, lost } = back ? { words: "" } : lesson(view);
  const learned = view.learned_in && (lost ? "lost" : "learned");
  const stands = over(view, now) ? "over" : status.replace(" ", "-");
  const mark = back ? "taken" : (learned ?? stands);
  const what = namedAmong(correction, views);
  return html`
    <li class=${mark}>
      <span class="what">${back ? html`<s>${what}</s>` : what}</span>
      <span class="where">${standing(view, words, now)}${back && " · taken back"}${fresh(view)}</span>
      <small>${who} · ${clock(correction.created_ns / 1e6)}</small>
      ${mine(view, gone) &&
      html`
        <button
          class="back"
          aria-label=${`Take back ${named(correction)}`}
          title="Take back"
          onClick=${() => takeBack(view)}
        >
          ↶
        </button>
      `}
    </li>
  `;
}

const told = new Set(); // of whom it was said that they were overruled

/** Say so, when somebody else's word came to hold instead of one's own. */
export function watchOverruled({ type, correction: view }) {
  const by = type === "correction" && view.replaced_by;
  const own = by && view.correction.author === author() && by.author !== author();
  if (!own || told.has(view.correction.id)) return;
  told.add(view.correction.id);
  tell(...overruled(view));
}

/** Say so, when somebody else lets a robot carry on that one froze oneself. */
export function watchLifted({ type, correction: view }) {
  const lifts = type === "correction" && view.correction.kind === "resume" && view.status === "in force";
  if (!lifts || view.correction.author === author() || told.has(view.correction.id)) return;
  told.add(view.correction.id);
  const { robot } = view.correction;
  const before = (state.corrections[robot] ?? []).filter(
    (one) => one.status === "in force" && one.sequence < view.sequence,
  );
  const ofKind = (kind) => before.filter(({ correction }) => correction.kind === kind);
  const last = Math.max(0, ...ofKind("resume").map(({ sequence }) => sequence));
  const own = ofKind("pause").some((one) => one.sequence > last && one.correction.author === author());
  if (own) tell(`${view.correction.author} let ${robot} carry on, which you froze`, "bad");
}

const fresh = ({ phrase, learned_in }) =>
  phrase && !phrase.known && !learned_in ? " · new to the low level" : "";
