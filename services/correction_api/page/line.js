// The one line of a page that is read out. A page with several live regions talks over itself: what
// stands elsewhere and shall be heard, too, goes through this one.
import { Component, html } from "./html.js";
import { state, touch } from "./store.js";

/** What was told last. hushed: it is only seen, while a dialog has the one that is read out;
 *  before: what stood in it when that came, and is no news there. */
export function Line({ hushed, before }) {
  const { mark, text } = state.line === before ? {} : state.line;
  return html`
    <p class=${`line ${mark ?? ""}`} role=${hushed ? null : "status"} aria-atomic="false">
      ${text}${state.aside && html`<span class="unseen">${" "}${state.aside}</span>`}
    </p>
  `;
}

let coming = [];

/** Have it read out, and not seen in the line; what comes together is read as one. */
function whisper(text) {
  coming.push(text);
  if (coming.length > 1) return;
  queueMicrotask(() => {
    state.aside = coming.join(" ").trim();
    coming = [];
    touch();
  });
}

/** A paragraph in its place that is read out when it comes, and whenever it changes; `quiet`: when
 *  it changes. What is hidden in it from those who listen is not read. */
export class Aloud extends Component {
  componentDidMount() {
    this.read();
  }

  componentDidUpdate() {
    this.read();
  }

  componentWillUnmount() {
    if (this.last) whisper("");
  }

  read() {
    const text = heard(this.place);
    if (text === (this.last ?? "")) return;
    const first = this.last === undefined;
    this.last = text;
    if (!(first && this.props.quiet)) whisper(text);
  }

  render({ children, quiet: _, ...rest }) {
    return html`<p ref=${(place) => (this.place = place)} ...${rest}>${children}</p>`;
  }
}

const heard = (place) =>
  [...place.childNodes]
    .filter((node) => node.getAttribute?.("aria-hidden") !== "true")
    .map(({ textContent }) => textContent)
    .join("")
    .replace(/\s+/g, " ")
    .trim();
