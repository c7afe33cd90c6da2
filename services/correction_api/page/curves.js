// Curves with bands, drawn by uPlot in the colours of the page; the same figures stand in a table.
import { Component, html } from "./html.js";
import uPlot from "./vendor/uplot.js";

const DASH = [6, 5];

/**
 * One plot. x: numbers, names: what is written at them instead, by the number. curves: { label,
 * y, low, high, colour (a CSS variable), dashed, dots (points on a dashed line, too) }; null where there is nothing. top: of the y axis.
 * apart: points with intervals instead of lines, where x is no sequence; so they are where there is
 * one point only, of which no band could be drawn.
 */
export class Curves extends Component {
  componentDidMount() {
    this.eye = new ResizeObserver(() => this.draw());
    this.eye.observe(this.box);
  }

  componentDidUpdate() {
    this.draw();
  }

  componentWillUnmount() {
    this.eye.disconnect();
    this.plot?.destroy();
  }

  draw() {
    const { x, curves } = this.props;
    const [width, height] = [Math.round(this.box.clientWidth), this.props.height ?? 230];
    const content = JSON.stringify([x, curves, width, height]);
    if (!width || content === this.drawn) return;
    this.drawn = content;
    this.plot?.destroy();
    const data = [x, ...curves.flatMap(({ y, low, high }) => [y, low ?? y, high ?? y])];
    this.plot = new uPlot(options(this.props, width, height), data, this.box);
  }

  render({ label }) {
    return html`<div class="curves" role="img" aria-label=${label} ref=${(box) => (this.box = box)} />`;
  }
}

function options(props, width, height) {
  const { x, curves, names, xLabel, top, percent, marks = [] } = props;
  const apart = props.apart || x.length === 1;
  const style = getComputedStyle(document.body);
  const colour = (name) => style.getPropertyValue(name).trim();
  const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line"), width: 1 }, font: "12px sans-serif", ticks: { show: false } };
  const [first, last] = [x[0] ?? 0, x.at(-1) ?? 1];
  const margin = names ? 0.4 : 0;
  return {
    width,
    height,
    legend: { show: false },
    cursor: { show: false },
    scales: {
      x: { time: false, range: [first - margin, last + margin] },
      y: { range: [0, top ?? highest(curves)] },
    },
    axes: [
      { ...axis, label: xLabel, labelFont: "12px sans-serif", labelSize: 18, size: 30, ...at(x, names) },
      { ...axis, size: 46, values: (_, ticks) => ticks.map((tick) => (percent ? `${Math.round(100 * tick)} %` : tick)) },
    ],
    series: [{}, ...curves.flatMap((curve) => series({ ...curve, apart }, colour))],
    bands: curves.flatMap((curve, index) =>
      curve.low && !apart ? [band(curve, index, colour)] : [],
    ),
    hooks: {
      draw: [
        (plot) => marks.forEach((mark) => line(plot, mark, colour)),
        (plot) => apart && curves.forEach((curve, index) => whiskers(plot, x, curve, index, colour)),
      ],
    },
  };
}

const at = (x, names) =>
  names && { splits: () => x, values: () => x.map((place) => names[place] ?? "") };

function series({ label, dashed, dots, colour: name, apart }, colour) {
  const points = { show: !apart && (!dashed || dots), size: 8, fill: colour(name), stroke: colour(name) };
  const edge = { stroke: null, width: 0, points: { show: false }, spanGaps: true };
  const stroke = apart ? "transparent" : colour(name);
  return [{ label, stroke, width: 2, dash: dashed ? DASH : [], points, spanGaps: true }, edge, edge];
}

function band({ colour: name }, index, colour) {
  return { series: [3 * index + 3, 3 * index + 2], fill: `${colour(name)}2b` };
}

/** A point and its interval, beside those of the other curves: what is no sequence has no line. */
function whiskers(plot, x, { y, low, high, colour: name }, index, colour) {
  const { ctx } = plot;
  const pixels = devicePixelRatio;
  const aside = (14 * index - 7) * pixels;
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = colour(name);
  ctx.lineWidth = 2 * pixels;
  x.forEach((place, at) => {
    if (y[at] === null) return;
    const left = plot.valToPos(place, "x", true) + aside;
    if (low && low[at] !== null) {
      ctx.beginPath();
      ctx.moveTo(left, plot.valToPos(low[at], "y", true));
      ctx.lineTo(left, plot.valToPos(high[at], "y", true));
      ctx.stroke();
    }
    ctx.beginPath();
    if (index) ctx.rect(left - 4 * pixels, plot.valToPos(y[at], "y", true) - 4 * pixels, 8 * pixels, 8 * pixels);
    else ctx.arc(left, plot.valToPos(y[at], "y", true), 4.5 * pixels, 0, 2 * Math.PI);
    ctx.fill();
  });
  ctx.restore();
}

/** A vertical line, where a slider stands. */
function line(plot, { x, colour: name }, colour) {
  const { ctx, bbox } = plot;
  const place = plot.valToPos(x, "x", true);
  ctx.save();
  ctx.strokeStyle = colour(name);
  ctx.setLineDash(DASH);
  ctx.beginPath();
  ctx.moveTo(place, bbox.top);
  ctx.lineTo(place, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/** Where nothing is more than 0, the axis goes to 1: figures nobody measured say nothing. */
function highest(curves) {
  const values = curves.flatMap(({ y, high }) => [...y, ...(high ?? [])]);
  return 1.15 * Math.max(0, ...values.filter((value) => value !== null)) || 1;
}

/** What the colours mean. */
export const Legend = ({ curves }) => html`
  <ul class="legend">
    ${curves.map(
      ({ label, colour, dashed }) => html`
        <li key=${label}>
          <svg width="26" height="10" aria-hidden="true">
            <path class=${colour.slice(2)} d="M1 5H25" stroke-dasharray=${dashed ? "6 5" : null} />
          </svg>
          ${label}
        </li>
      `,
    )}
  </ul>
`;
