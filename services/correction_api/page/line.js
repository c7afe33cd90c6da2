// The one line of a page that is read out. A page with several live regions talks over itself.
import { html } from "./html.js";
import { state } from "./store.js";

/** What was told last. hushed: it is only seen, while a dialog has the one that is read out;
 *  before: what stood in it when that came, and is no news there. */
export function Line({ hushed, before }) {
  const { mark, text } = state.line === before ? {} : state.line;
  return html`<p class=${`line ${mark ?? ""}`} role=${hushed ? null : "status"}>${text}</p>`;
}
