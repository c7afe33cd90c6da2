// All keys, and how to give an action another one.
import { ACTIONS, label, toggleHelp } from "./actions.js";
import { Component, html } from "./html.js";
import { changed, keyOf, reset, shown } from "./keymap.js";
import { capture } from "./keys.js";
import { state, tell, touch } from "./store.js";

export class Help extends Component {
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
          not at all), since two begin a phrase. Press a key here to change it.
        </p>
        ${state.conflict && html`<p class="conflict" role="alert">${state.conflict}</p>`}
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
    Object.assign(state, { capture: null, conflict: "" });
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
        aria-label=${`Key for: ${label(name)}, now ${shown(keyOf(name))}`}
        onClick=${() => begin(name)}
      >
        ${waits ? "press a key …" : html`<kbd>${shown(keyOf(name))}</kbd>`}
      </button>
    </li>
  `;
}

function begin(name) {
  state.conflict = "";
  capture(name);
}

function toggleKeys(event) {
  state.keys = event.target.checked;
  touch();
}

function asTheyCame() {
  reset();
  Object.assign(state, { capture: null, conflict: "" });
  tell("All keys are as they came", "good");
}
