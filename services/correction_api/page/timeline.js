// The timeline of an episode: rows over control steps, a cursor, and a stretch that one drags; or,
// without `seek` and `select`, a picture of it. It is `width` px wide, of which [from, to] can be `seen`.
import { isPolicy, STEPS_A_SECOND } from "./account.js";
import { Component, html } from "./html.js";
import { still } from "./stills.js";
import { called } from "./words.js";

const DRAG_PX = 5;
const LABEL = 15;
const LEAST = 5; // Fewer signs say nothing.
const PICTURE = 48; // as wide as one is drawn, px
const INSET = 5; // From the edge of what is drawn to its text, px.
export const GLYPHS = {
  start: "S",
  interval: "·",
  completion: "✓",
  stuck: "!",
  interjection: "✎",
  expiry: "E",
  untold: "?",
};
const ROWS = [
  ["command", "command in force", 30],
  ["proposals", "score of what π_HL would rather do", 34],
  ["asked", "why π_HL was asked", 16],
  ["doubt", "doubt", 24],
  ["said", "said: ▹ began, ○ saw, ● in force", 26],
  ["after", "said afterwards", 24],
  ["pictures", "pictures", 44],
];
const TOP = rowTops();

function rowTops() {
  let y = 20;
  const tops = {};
  for (const [name, , height] of ROWS) {
    tops[name] = y + LABEL;
    y += LABEL + height + 9;
  }
  return { ...tops, end: y };
}

export class Timeline extends Component {
  stepAt(event) {
    const { left, width } = this.svg.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - left) / width));
    return Math.round(share * this.props.episode.steps);
  }

  down = (event) => {
    if (!event.isPrimary) return this.drop(); // Two fingers zoom.
    if (event.button || !this.props.seek) return;
    this.from = { x: event.clientX, step: this.stepAt(event), before: this.props.span, dragged: false };
    this.svg.setPointerCapture(event.pointerId);
  };

  move = (event) => {
    if (!this.from) return;
    this.from.dragged ||= Math.abs(event.clientX - this.from.x) >= DRAG_PX;
    if (!this.from.dragged) return;
    const ends = [this.from.step, this.stepAt(event)].sort((one, other) => one - other);
    if (ends[1] > ends[0]) this.props.select(ends, true);
  };

  up = (event) => {
    if (!this.from) return;
    if (this.from.dragged) this.props.select(this.props.span, false);
    else this.props.seek(this.stepAt(event));
    this.from = null;
  };

  /** It was no drag: the stretch is as it was before. */
  drop = () => {
    if (this.from?.dragged) this.props.select(this.from.before, false);
    this.from = null;
  };

  /** What it is for a screen reader: a slider that goes by keys, or a picture. */
  role() {
    const { episode, cursor, seek } = this.props;
    const { decisions, steps } = episode;
    const seconds = (steps / STEPS_A_SECOND).toFixed(1);
    if (!seek) return { role: "img", "aria-label": `${decisions.length} decisions in ${seconds} s` };
    const at = decisions[cursor];
    return {
      role: "slider",
      tabindex: "0",
      "aria-label": "Decision at the cursor",
      "aria-valuemin": "0",
      "aria-valuemax": Math.max(0, decisions.length - 1),
      "aria-valuenow": cursor,
      "aria-valuetext": at ? `step ${at.step}, ${at.executed.text}` : "no decision",
    };
  }

  render({ episode, cursor, span, width, seen }) {
    const { decisions, steps } = episode;
    const x = (step) => (step / Math.max(1, steps)) * width;
    const at = decisions[cursor];
    const drawn = { viewBox: `0 0 ${width} ${TOP.end}`, height: TOP.end };
    return html`
      <div class="timeline" ...${this.role()}>
        <svg ...${drawn}><${Axis} ...${{ steps, x, width }} /></svg>
        <svg class="names" height=${TOP.end}>
          ${ROWS.map(
            ([name, text]) => html`<text class="row" x="0" y=${TOP[name] - 4}>${text}</text>`,
          )}
        </svg>
        <svg
          class="rows"
          ...${drawn}
          ref=${(svg) => (this.svg = svg)}
          onPointerDown=${this.down}
          onPointerMove=${this.move}
          onPointerUp=${this.up}
          onPointerCancel=${this.drop}
        >
          <defs>
            <pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse">
              <path class="hatch" d="M0 6 6 0" />
            </pattern>
          </defs>
          <${Commands} ...${{ episode, x, seen }} />
          <${Proposals} ...${{ decisions, steps, x }} />
          <${Doubt} ...${{ decisions, calls: episode.account.calls, steps, x }} />
          <${Said} ...${{ said: episode.said, x, seen }} />
          <${Strip} ...${{ episode, x, width, seen }} />
          ${span &&
          html`<rect class="span" x=${x(span[0])} y="18" width=${x(span[1]) - x(span[0])}
            height=${TOP.end - 20} />`}
          ${at && html`<path class="cursor" d=${`M${x(at.step)} 14V${TOP.end}`} />`}
        </svg>
      </div>
    `;
  }
}

function Axis({ steps, x, width }) {
  const seconds = steps / STEPS_A_SECOND;
  const wanted = Math.max(2, Math.floor(width / 90));
  const gap = [0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120].find((one) => seconds / one <= wanted) ?? 300;
  const marks = Array.from({ length: Math.floor(seconds / gap) + 1 }, (_, at) => at * gap);
  return marks.map((second) => {
    const place = x(second * STEPS_A_SECOND);
    const anchor = place > width - 24 ? "end" : place ? "middle" : "start";
    return html`
      <path class="grid" d=${`M${place} 16V${TOP.end}`} />
      <text class="axis" x=${place} y="11" text-anchor=${anchor}>${Number(second.toFixed(1))} s</text>
    `;
  });
}

function Commands({ episode, x, seen }) {
  return episode.segments.map(({ from, to, text, by }, at) => {
    const person = !isPolicy(by);
    const wide = Math.max(0, x(to) - x(from) - 1);
    const kind = person ? "person" : `policy ${at % 2 ? "odd" : ""}`;
    return html`
      <svg x=${x(from)} y=${TOP.command} width=${wide} height="30" class=${`command ${kind}`}>
        <title>${text}, steps ${from} to ${to}, chosen by ${person ? "a person" : by}</title>
        <rect width="100%" height="100%" />
        ${person && html`<rect class="hatched" width="100%" height="100%" />`}
        <${Words} ...${{ text: person ? `✎ ${text}` : text, wide, y: 19, hidden: seen[0] - x(from) }} />
      </svg>
    `;
  });
}

/** hidden: so much of the stretch lies before what is seen, px. */
function Words({ text, wide, y, hidden }) {
  const past = Math.max(0, hidden);
  return html`<text x=${past + INSET} y=${y}>${fitted(text, wide - past)}</text>`;
}

const pen = document.createElement("canvas").getContext("2d"); // It knows how wide words are.

/** As much of a text as there is room for, in the face of commands. */
function fitted(text, wide) {
  const room = wide - 2 * INSET;
  const fits = (words) => pen.measureText(words).width <= room;
  pen.font = `italic 13.5px ${getComputedStyle(document.body).getPropertyValue("--serif")}`;
  if (fits(text)) return text;
  const shorter = (count) => `${text.slice(0, count).trimEnd()}…`;
  let count = text.length - 1;
  while (count >= LEAST && !fits(shorter(count))) count -= 1;
  return count < LEAST ? "" : shorter(count);
}

function Proposals({ decisions, steps, x }) {
  return decisions.map((one, at) => {
    const best = one.proposed[0];
    const wide = Math.max(1, x(decisions[at + 1]?.step ?? steps) - x(one.step) - 1);
    const other = best.goal.text !== one.executed.text;
    const high = Math.max(1, 32 * best.score);
    return html`
      <rect class=${`bar ${other ? "other" : ""}`} x=${x(one.step)}
        y=${TOP.proposals + 33 - high} width=${wide} height=${high}>
        <title>${best.goal.text} ${best.score.toFixed(2)}${other ? ", not in force" : ""}</title>
      </rect>
      <text class=${`asked ${one.asked}`} x=${x(one.step) + wide / 2} y=${TOP.asked + 12}
        text-anchor="middle">${GLYPHS[one.asked ?? "untold"]}</text>
    `;
  });
}

function Doubt({ decisions, calls, steps, x }) {
  const most = Math.max(1.5, ...decisions.map(({ entropy }) => entropy));
  const points = decisions.map(
    ({ step, entropy }) => `${x(step)} ${TOP.doubt + 22 - (20 * entropy) / most}`,
  );
  return html`
    ${calls.map(
      (call) => html`
        <rect class="call" x=${x(call.step)} y=${TOP.doubt}
          width=${Math.max(12, x(Math.min(steps, call.step + STEPS_A_SECOND)) - x(call.step))}
          height="24"><title>asked for help: ${call.reason}</title></rect>
        <text class="asks" x=${x(call.step) + 3} y=${TOP.doubt + 11}>?</text>
      `,
    )}
    ${points.length > 0 && html`<path class="doubt" d=${`M${points.join("L")}`} />`}
  `;
}

const LIVE = ["override", "release", "pause", "resume"];

function Said({ said, x, seen }) {
  const y = TOP.said + 12;
  return said.map((one) => {
    const name = `${called(one.kind)} ${one.text ?? ""}: ${one.state}`;
    if (one.span && ["relabel", "fault", "override"].includes(one.kind)) {
      const [from, to] = one.span.map(x);
      const wide = Math.max(3, to - from);
      return html`
        <svg x=${from} y=${TOP.after} width=${wide} height="22"
          class=${`window ${one.retracted ? "gone" : ""}`} data-said=${one.view.correction.id}>
          <title>${name}</title>
          <rect width="100%" height="100%" rx="3" />
          <${Words} text=${one.text ?? "the hand slipped"} ...${{ wide, y: 15, hidden: seen[0] - from }} />
        </svg>
      `;
    }
    if (!LIVE.includes(one.kind) || one.inForce === null) return null;
    const places = [one.begun, one.seen, one.inForce].filter((step) => step !== null).map(x);
    return html`
      <g class=${`mark ${one.kind} ${one.retracted ? "gone" : ""}`}>
        <title>${name}</title>
        <path class="reach" d=${`M${Math.min(...places)} ${y}H${Math.max(...places)}`} />
        ${one.begun !== null && html`<text x=${x(one.begun) - 9} y=${y + 5}>▹</text>`}
        ${one.seen !== null && html`<circle class="seen" cx=${x(one.seen)} cy=${y} r="5.5" />`}
        <circle class="force" cx=${x(one.inForce)} cy=${y} r="3.5" />
      </g>
    `;
  });
}

/** Pictures where their decisions are, as many as there is room for. */
function Strip({ episode: { account, decisions }, x, width, seen }) {
  let free = 0;
  const placed = decisions.filter(({ step }) => {
    const fits = x(step) >= free && x(step) + PICTURE <= width;
    if (fits) free = x(step) + PICTURE + 2;
    return fits;
  });
  return placed
    .filter(({ step }) => x(step) + 2 * PICTURE > seen[0] && x(step) - PICTURE < seen[1])
    .map(({ id, step }) => html`<${Picture} key=${id} episode=${account.id} decision=${id} x=${x(step)} />`);
}

/** It is asked for when it can be seen. */
class Picture extends Component {
  async componentDidMount() {
    this.setState({ url: await still(this.props.episode, this.props.decision, "angle") });
  }

  render({ x }, { url }) {
    return (
      url &&
      html`<image href=${url} x=${x} y=${TOP.pictures} width=${PICTURE} height="44"
        preserveAspectRatio="xMidYMid slice" />`
    );
  }
}
