// The palette: a field for words of one's own, with the known commands that fit, and what the
// robot would make of a phrase that it doesn't know.
import { get } from "./api.js";
import { rank } from "./fuzzy.js";
import { Component, html } from "./html.js";
import { aria, keyOf, shown } from "./keymap.js";
import { say } from "./say.js";
import { touch } from "./store.js";
import { verdict } from "./verdict.js";
import { percent } from "./words.js";

const SHOWN = 6;
const PAUSE_MS = 150; // after the last letter, before the robot is asked
const NEAR = 0.01; // A phrase that is less like a command is like none.
const HOLDS = [
  ["", "holds"],
  ["100", "2 s"],
  ["250", "5 s"],
];

let field = null;
let palette = null;
const drafts = {}; // by robot: what was typed and not said yet

/** Put the keyboard into the field, and what was typed so far; the person begins to say something.
 *  A draft from before gives way to the first letter: a click goes on with it. */
export function openPalette(typed = "") {
  const entered = document.activeElement !== field;
  field?.focus();
  if (entered) palette?.anew();
  if (typed) palette?.type((entered ? "" : palette.state.text) + typed);
}

export function closePalette() {
  field?.blur();
}

export class Palette extends Component {
  constructor({ robot }) {
    super();
    const draft = drafts[robot.robot] ?? { text: "", hold: "", begun: null };
    this.state = { ...draft, open: false, at: -1, known: [], read: null };
  }

  componentDidMount() {
    palette = this;
  }

  componentWillUnmount() {
    const { text, hold, begun } = this.state;
    drafts[this.props.robot.robot] = { text, hold, begun };
    clearTimeout(this.pause);
  }

  render({ robot }, { text, hold, open, at }) {
    const options = open ? this.options() : [];
    const words = options[at]?.text ?? text.trim();
    const chosen = options[at] ? `option-${at}` : undefined;
    return html`
      <form class="palette" onSubmit=${(event) => this.send(event, words)}>
        <div class="field">
          <input
            ref=${(input) => (field = input)}
            type="text"
            name="words"
            role="combobox"
            maxlength="200"
            autocomplete="off"
            spellcheck=${false}
            enterkeyhint="send"
            placeholder="In your own words"
            aria-label=${`What ${robot.robot} shall do, in your own words`}
            aria-expanded=${String(options.length > 0)}
            aria-controls="known-commands"
            aria-autocomplete="list"
            aria-activedescendant=${chosen}
            aria-keyshortcuts=${aria("palette")}
            value=${text}
            onFocus=${() => this.open()}
            onBlur=${() => this.setState({ open: false })}
            onInput=${(event) => this.type(event.target.value)}
            onKeyDown=${(event) => this.move(event, options.length)}
          />
          <kbd aria-hidden="true">${shown(keyOf("palette"))}</kbd>
        </div>
        <select
          aria-label="How long it holds"
          value=${hold}
          onChange=${(event) => this.setState({ hold: event.target.value })}
        >
          ${HOLDS.map(([steps, label]) => html`<option value=${steps}>${label}</option>`)}
        </select>
        <button class="say" disabled=${!words}>Say</button>
        <ul id="known-commands" role="listbox" aria-label="Commands" hidden=${!options.length}>
          ${options.map((option, place) => this.row(option, place))}
        </ul>
      </form>
    `;
  }

  row({ text, note, kind, reason }, place) {
    const hold = (event) => event.preventDefault(); // The field keeps the keyboard.
    return html`
      <li
        key=${`${kind}/${text}`}
        id=${`option-${place}`}
        role="option"
        class=${kind}
        aria-selected=${String(place === this.state.at)}
        onPointerDown=${hold}
        onMouseDown=${hold}
        onClick=${() => this.tell(text)}
      >
        <q>${text}</q>
        ${note && html`<small>${note}</small>`}
        ${reason && html`<p>${reason}</p>`}
      </li>
    `;
  }

  /** What can be chosen: known commands that fit, the phrase as it stands, and the nearest ones. */
  options() {
    const { text, known } = this.state;
    const typed = text.trim();
    if (isStop(typed)) return [{ text: typed, kind: "known", note: "freezes the robot" }];
    const fits = rank(typed, known, this.props.robot.prompt ?? "").slice(0, SHOWN);
    const [sure, guessed] = [false, true].map((guess) =>
      fits.filter((fit) => fit.guessed === guess).map(({ text: command, inPrompt }) => ({
        text: command,
        kind: "known",
        note: inPrompt ? "known · in the prompt" : "known",
      })),
    );
    if (!typed || known.includes(typed.toLowerCase())) return sure;
    const shownAlready = new Set(fits.map((fit) => fit.text));
    const [asTyped, ...near] = this.phrase(typed, shownAlready);
    return [...sure, asTyped, ...guessed, ...near]; // Enter alone says no guess.
  }

  phrase(typed, shownAlready) {
    const read = this.state.read?.text === typed ? this.state.read : null;
    const near = (read?.nearest ?? [])
      .filter(({ command, score }) => score >= NEAR && !shownAlready.has(command))
      .map(({ command, score }) => ({
        text: command,
        kind: "near",
        note: `nearest known · ${percent(score)}`,
      }));
    return [{ text: typed, ...verdict(read) }, ...near];
  }

  async open() {
    const { robot } = this.props.robot;
    const { text, begun } = this.state;
    this.setState({ open: true, at: text ? 0 : -1, begun: text ? begun : Date.now() });
    field?.form.scrollIntoView({ block: "start" }); // Its list needs the room below.
    try {
      const { commands } = await get(`robots/${robot}/commands`);
      if (this.props.robot.robot === robot) this.setState({ known: commands });
    } catch {
      // Nobody can be asked now: what was known will do.
    }
  }

  /** What comes now is another phrase than the draft, if there is one. */
  anew() {
    this.fresh = true;
    field?.select();
  }

  type(text) {
    const begun = this.state.text && !this.fresh ? this.state.begun : Date.now();
    this.fresh = false;
    this.setState({ text, at: text.trim() ? 0 : -1, begun, open: true });
    clearTimeout(this.pause);
    if (text.trim()) this.pause = setTimeout(() => this.read(text.trim()), PAUSE_MS);
  }

  /** Ask the robot what it would make of the phrase. */
  async read(text) {
    const { robot } = this.props.robot;
    try {
      const read = await get(`robots/${robot}/phrase?text=${encodeURIComponent(text)}`);
      if (this.state.text.trim() === text) this.setState({ read });
    } catch (error) {
      if (this.state.text.trim() === text) this.setState({ read: { text, unknown: error.message } });
    }
  }

  /** While nothing is typed, nothing is chosen until an arrow chooses it. */
  move(event, count) {
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!by || !count) return;
    event.preventDefault();
    const from = Math.max(this.state.at, by > 0 ? -1 : 0);
    this.setState({ at: (from + by + count) % count });
  }

  send(event, words) {
    event.preventDefault();
    if (words) this.tell(words);
  }

  tell(text) {
    const { hold, begun } = this.state;
    const words = { kind: "override", text, ...(hold && { hold_steps: Number(hold) }) };
    say(this.props.robot.robot, isStop(text) ? { kind: "pause" } : words, begun ?? Date.now());
    clearTimeout(this.pause);
    this.setState({ text: "", begun: null, read: null, open: false });
    field?.blur();
    touch();
  }
}

/** Who types this wants the robot to stand still, and no word that is learned. */
const isStop = (text) => /^(stop|halt|freeze)[.!]*$/i.test(text.trim());
