// The robot in focus: what it sees, what it does, who chose that, and what it did so far.
import { Component, html } from "./html.js";
import { Picture } from "./pictures.js";
import { callOf, others, state } from "./store.js";
import { doing, doubt, works } from "./words.js";

const SPANS = 8;
const SLOW = 0.5; // From this share of its rate on, a person sees that a picture lags.
const TOLD = 64; // So many commands of an episode the service tells, and no earlier ones.

/** One for each robot: whoever goes to another one, from wherever on a small page, sees it. */
export class Focus extends Component {
  componentDidMount() {
    this.section.firstElementChild.scrollIntoView({ block: "nearest" }); // It may have no box itself.
  }

  render({ robot, turn }) {
    const { robot: name, presence, by, state } = robot;
    const marks = [presence, by ?? "", state === "paused" ? "frozen" : ""].join(" ");
    return html`
      <section
        class=${`focus ${marks}`}
        data-robot=${name}
        aria-label=${`${name}, in focus`}
        ref=${(section) => (this.section = section)}
      >
        <${Title} robot=${robot} />
        <div class="sight">
          <div class="pictures">
            <p class="blank">${blank(robot)}</p>
            <${Picture} key=${`${name}/angle`} robot=${name} camera="angle" rate="full" turn=${turn} />
            <${Picture} key=${`${name}/top`} robot=${name} camera="top" rate="full" turn=${turn} />
            ${state === "paused" && html`<p class="stopped">Frozen</p>`}
          </div>
          <${Caption} robot=${robot} />
        </div>
        <${Course} robot=${robot} />
      </section>
    `;
  }
}

/** Why there is no picture, as long as there is none. */
function blank({ robot, presence, episode }) {
  if (presence !== "online") return `No picture came from ${robot}, which is ${presence}.`;
  if (episode) return `The first picture of ${robot} is on its way.`;
  const rests = `${robot} is between two episodes: its picture comes with the next one`;
  return works(state.learner) ? `${rests}. It may wait for the version that the learner makes.` : `${rests}.`;
}

function Title({ robot }) {
  const call = callOf(robot.robot);
  const mark = robot.presence === "online" ? robot.state : robot.presence;
  return html`
    <div class="title">
      <h2>${robot.robot}</h2>
      <span class=${`doing ${mark}`}>${doing(robot)}</span>
      ${call &&
      html`<span class="doing doubt">
        ${doubt(call)}${call.waits_s ? `, waits ${Math.ceil(call.waits_s)} s` : ""}
      </span>`}
      ${others(robot.robot).map(({ name }) => html`<span class="doing">${name} is here, too</span>`)}
      ${robot.pictures < SLOW &&
      html`<span class="doing" title="Its control loop needs the time">pictures slowed</span>`}
      <span class="facts">
        episode ${robot.number} · step <b>${robot.step}</b> · π_HL <b>${robot.version}</b>
      </span>
      <p class="prompt">${robot.prompt ?? "between two episodes"}</p>
    </div>
  `;
}

function Caption({ robot }) {
  if (!robot.command) return html`<p class="caption none">no command in force</p>`;
  const who = robot.by === "policy" ? `π_HL ${robot.chosen_by}` : (robot.author ?? "a person");
  return html`
    <p class="caption">
      <q>${robot.command.text}</q>
      <span class="who">${robot.by === "policy" ? "chosen by" : "told by"} ${who}</span>
    </p>
  `;
}

/** The last commands, each as wide as it was long in force; the newest is in view. */
class Course extends Component {
  componentDidMount() {
    this.componentDidUpdate();
  }

  componentDidUpdate() {
    const newest = this.props.robot.course.at(-1)?.step;
    if (newest === this.newest) return;
    this.newest = newest;
    this.list.scrollLeft = this.list.scrollWidth;
  }

  render({ robot: { course, step, episode } }) {
    const spans = course.map((span, at) => ({ ...span, end: course[at + 1]?.step ?? step }));
    const before = Math.max(0, spans.length - SPANS);
    return html`
      <ol
        class="course"
        tabindex="0"
        aria-label="Commands so far in this episode"
        ref=${(list) => (this.list = list)}
      >
        ${before > 0 &&
        episode &&
        html`<li class="before">
          <a href=${`episode.html?id=${episode}`} title="The whole episode, decision by decision">
            ${before}${course.length < TOLD ? "" : " or more"} before
          </a>
        </li>`}
        ${spans.slice(before).map((span) => html`<${Span} key=${span.step} ...${span} />`)}
      </ol>
    `;
  }
}

function Span({ step, end, text, by }) {
  return html`
    <li
      class=${by}
      style=${{ flexGrow: Math.max(10, end - step) }}
      title=${`${text}, from step ${step}, ${by === "person" ? "told by a person" : "π_HL"}`}
    >
      <span>${by === "person" && html`<i aria-label="told">✎</i> `}${text}</span>
      <small>${step}</small>
    </li>
  `;
}
