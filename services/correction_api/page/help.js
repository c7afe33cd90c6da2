// All keys, and how to give an action another one.
import { ACTIONS, label, toggleHelp } from "./actions.js";
import { Component, html } from "./html.js";
import { changed, keyOf, reset, shown } from "./keymap.js";
import { capture } from "./keys.js";
import { Line } from "./line.js";
import { state, tell, touch } from "./store.js";

const WAITS = "press a key …";

export class Help extends Component {
  before = state.line;

  componentDidMount() {
    this.dialog.showModal();
  }

  render() {
    return html`
      <dialog
        class="keys"
        ref=${(dialog) => (this.dialog = dialog)}
        aria-labelledby="keys-title"
        onClose=${() => this.leave()}
      >
        <header>
          <h2 id="keys-title">Keys</h2>
          <button onClick=${() => this.dialog.close()}>Close</button>
        </header>
        <p class="how">
          They act on the robot in focus, and rest while you type. A letter waits half a second (Enter:
          not at all), since two may begin a phrase; two that begin no word, such as y n, act at once.
          Press a key here to change it.
        </p>
        <${Line} before=${this.before} />
        <ul>
          ${Object.keys(ACTIONS).map((name) => html`<${Row} key=${name} name=${name} />`)}
        </ul>
        <footer>
          <label>
            <input type="checkbox" name="keys" checked=${state.keys} onChange=${toggleKeys} />
            Single keys act (those that freeze always do)
          </label>
          <button onClick=${asTheyCame} disabled=${!changed()}>Reset all</button>
        </footer>
      </dialog>
    `;
  }

  leave() {
    state.capture = null;
    if (state.asking) toggleHelp();
  }
}

function Row({ name }) {
  const waits = state.capture === name;
  return html`
    <li>
      <span>${label(name)}</span>
      <button
        class=${waits ? "waits" : ""}
        aria-label=${`Key for: ${label(name)}, ${waits ? WAITS : `now ${shown(keyOf(name))}`}`}
        onClick=${() => begin(name)}
      >
        ${waits ? WAITS : html`<kbd>${shown(keyOf(name))}</kbd>`}
      </button>
    </li>
  `;
}

function begin(name) {
  capture(name);
  tell(state.capture ? `Press a key for “${label(name)}”` : "");
}

function toggleKeys(event) {
  state.keys = event.target.checked;
  touch();
}

function asTheyCame() {
  reset();
  state.capture = null;
  tell("All keys are as they came", "good");
}
