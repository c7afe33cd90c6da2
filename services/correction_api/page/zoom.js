// The window over the timeline of an episode: the whole of it, or a part, larger. What is drawn in it
// is so many times as wide and goes sideways; all rows do alike, and none knows of it.
import { Component, html } from "./html.js";
import { keyOf, shown } from "./keymap.js";
import { Timeline } from "./timeline.js";

const MARGIN_PX = 12; // What is at an end is drawn whole (`timeline.css`).
const STEP_PX = 10; // A step gets no wider: a decision of 0.4 s has room for its words.
const LINE_PX = 16; // Some wheels tell lines.
const NOTCH = 0.5; // A notch of a wheel is at most so many doublings.

/** A timeline, what zooms it, and other controls beside that (`children`); without `seek` the timeline
 *  alone. hold(zoom): gets what keys call. dragging: a stretch is being dragged. */
export class Zoom extends Component {
  state = { width: 800, times: 1, left: 0 };
  times = 1; // as wanted: state comes with the next drawing, and a wheel doesn't wait for it
  fingers = new Map(); // where each is on the glass, px
  window = (box) => (this.box = box);

  componentDidMount() {
    this.eye = new ResizeObserver(([entry]) => this.fit(Math.round(entry.contentRect.width)));
    this.eye.observe(this.box);
    this.props.hold?.(this);
  }

  componentWillUnmount() {
    this.eye.disconnect();
    this.props.hold?.(null);
  }

  /** Be as wide as there is room; what was in the middle stays there, as when a phone is turned. */
  fit(width) {
    const { width: before, left } = this.state;
    if (width === before) return;
    this.setState({ width });
    if (this.sheet) this.zoom(this.times, (left + before / 2) / (before * this.times), this.middle());
  }

  /** Zoom about the cursor, where it can be seen, or bring it to the middle; 0: the whole. */
  by(factor) {
    const { episode, cursor } = this.props;
    const step = episode.decisions[cursor]?.step ?? 0;
    const place = this.placeOf(step);
    this.zoom(this.times * factor, this.share(place), this.sees(place) ? place : this.middle());
  }

  /** Bring a step into view. While an episode plays that is a jump every half window, no motion. */
  show(step) {
    const place = this.placeOf(step);
    if (!this.sees(place)) this.box.scrollLeft += place - this.middle();
  }

  /** Be so many times as wide, with a share of the whole at a place of the screen, px. */
  zoom(wanted, share, place) {
    const most = (this.props.episode.steps * STEP_PX) / this.state.width;
    this.times = Math.max(1, Math.min(most, wanted));
    this.setState({ times: this.times }, () => {
      const { left, width } = this.sheet.getBoundingClientRect();
      this.box.scrollLeft += left + share * width - place;
      this.look();
    });
  }

  share(place) {
    const { left, width } = this.sheet.getBoundingClientRect();
    return (place - left) / width;
  }

  placeOf(step) {
    const { left, width } = this.sheet.getBoundingClientRect();
    return left + (step / Math.max(1, this.props.episode.steps)) * width;
  }

  sees(place) {
    const { left, right } = this.box.getBoundingClientRect();
    return place >= left + MARGIN_PX - 1 && place <= right - MARGIN_PX + 1;
  }

  middle() {
    const { left, width } = this.box.getBoundingClientRect();
    return left + width / 2;
  }

  look = () => {
    const left = this.box.scrollLeft;
    if (left !== this.state.left) this.setState({ left });
  };

  wheel = (event) => {
    if (!event.ctrlKey && !event.metaKey) return; // A pinch on a touchpad has `ctrlKey`, too.
    event.preventDefault();
    const px = event.deltaY * (event.deltaMode ? LINE_PX : 1);
    const power = Math.max(-NOTCH, Math.min(NOTCH, -px / 100));
    this.zoom(this.times * 2 ** power, this.share(event.clientX), event.clientX);
  };

  down = (event) => {
    if (event.isPrimary) this.fingers.clear();
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.fingers.size !== 2) return;
    const { middle, gap } = this.pinched();
    this.pinch = { gap, times: this.times, share: this.share(middle) };
  };

  move = (event) => {
    if (!this.fingers.has(event.pointerId)) return;
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.fingers.size === 2) {
      const { middle, gap } = this.pinched();
      this.zoom((this.pinch.times * gap) / this.pinch.gap, this.pinch.share, middle);
    } else if (this.props.dragging) {
      const { left, right } = this.box.getBoundingClientRect();
      this.box.scrollLeft += Math.max(0, event.clientX - right) - Math.max(0, left - event.clientX);
    }
  };

  up = (event) => this.fingers.delete(event.pointerId);

  pinched() {
    const [[x, y], [otherX, otherY]] = this.fingers.values();
    return { middle: (x + otherX) / 2, gap: Math.max(1, Math.hypot(x - otherX, y - otherY)) };
  }

  render(props, { width, times, left }) {
    const whole = times === 1;
    const timeline = html`<${Timeline} ...${props} width=${width * times} seen=${[left, left + width]} />`;
    if (!props.seek) return html`<div class="zoom" ref=${this.window}>${timeline}</div>`;
    return html`
      <div class=${whole ? "zoom whole" : "zoom near"} ref=${this.window} onScroll=${this.look}>
        <div
          style=${{ width: `${100 * times}%` }}
          ref=${(sheet) => (this.sheet = sheet)}
          onWheel=${this.wheel}
          onPointerDownCapture=${this.down}
          onPointerMoveCapture=${this.move}
          onPointerUpCapture=${this.up}
          onPointerCancelCapture=${this.up}
        >
          ${timeline}
        </div>
      </div>
      <div class="controls">
        <div class="closer" role="group" aria-label="Zoom">
          <${Closer} zoom=${() => this.by(1 / 2)} name="player-farther" label="Zoom out" sign="−" />
          <${Closer} zoom=${() => this.by(2)} name="player-closer" label="Zoom in" sign="+" />
          <${Closer} zoom=${() => this.by(0)} name="player-whole" label="The whole timeline" sign="whole" />
          <${Pan} box=${this.box} left=${left} most=${width * (times - 1)} />
        </div>
        ${props.children}
      </div>
    `;
  }
}

/** A key that is the sign itself is shown once. */
function Closer({ zoom, name, label, sign }) {
  const key = shown(keyOf(name));
  return html`
    <button onClick=${zoom}>
      ${key !== sign.replace("−", "-") && html`<kbd>${key}</kbd>`}
      <span aria-hidden="true">${sign}</span><span class="unseen">${label}</span>
    </button>
  `;
}

/** Goes sideways by a finger: one that is drawn over the timeline takes a stretch of it. */
const Pan = ({ box, left, most }) => html`
  <input
    type="range"
    aria-label="Part of the timeline in view"
    aria-valuetext=${`${Math.round((100 * left) / Math.max(1, most))} %`}
    min="0"
    max=${most}
    step="any"
    value=${left}
    disabled=${!most}
    onInput=${(event) => (box.scrollLeft = Number(event.target.value))}
  />
`;
