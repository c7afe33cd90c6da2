// The head of every page: where one is, the stop for all robots, and who one is.
import { html } from "./html.js";
import { aria, keyOf, shown } from "./keymap.js";
import { Nav } from "./nav.js";
import { sayToAll } from "./say.js";
import { setName, state } from "./store.js";

/** told: what stands in the middle; first, last: what stands beside the stop for all. */
export function Head({ here, told, first, last }) {
  return html`
    <header class="head">
      <h1><img src="icon.svg" alt="" width="20" height="20" /> <span>hl-dagger</span></h1>
      <${Nav} here=${here} />
      ${told}
      <div class="you">
        ${first}
        <button class="freeze-all" onClick=${() => sayToAll()} aria-keyshortcuts=${aria("freeze-all")}>
          Freeze all<kbd aria-hidden="true">${shown(keyOf("freeze-all"))}</kbd>
        </button>
        <label>
          <span>You are</span>
          <input
            name="author"
            aria-label="You are"
            size="8"
            maxlength="64"
            autocomplete="off"
            readonly=${Boolean(state.person)}
            value=${state.name}
            onInput=${(event) => setName(event.target.value)}
          />
        </label>
        ${last}
      </div>
    </header>
  `;
}
