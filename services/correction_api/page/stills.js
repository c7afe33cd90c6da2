// Pictures that the high level saw, fetched once each; by fetch, since an <img> sends no token.
import { token } from "./api.js";
import { Component, html } from "./html.js";

const KEPT = 300;
const BASE = new URL("api/v1/episodes/", document.baseURI);
const cache = new Map();

/** The URL of a picture that is here already, or will be; null where there is none. */
export function still(episode, decision, camera) {
  const path = `${episode}/stills/${decision}/${camera}`;
  if (!cache.has(path)) {
    cache.set(path, load(path));
    if (cache.size > KEPT) forget(cache.keys().next().value);
  }
  return cache.get(path);
}

async function load(path) {
  const headers = token.get() ? { Authorization: `Bearer ${token.get()}` } : {};
  const answer = await fetch(new URL(path, BASE), { headers }).catch(() => null);
  if (!answer?.ok) {
    cache.delete(path); // The learner may be back at the next look.
    return null;
  }
  return URL.createObjectURL(await answer.blob());
}

async function forget(path) {
  const url = await cache.get(path);
  cache.delete(path);
  if (url) URL.revokeObjectURL(url);
}

/** One camera at one decision; the picture before stays until the next one is here. */
export class Still extends Component {
  state = { url: null, missing: false, of: "" };

  componentDidMount() {
    this.look();
  }

  componentDidUpdate() {
    this.look();
  }

  async look() {
    const { episode, decision, camera } = this.props;
    if (!decision || this.state.of === decision) return;
    this.setState({ of: decision });
    const url = await still(episode, decision, camera);
    if (this.state.of === decision) this.setState({ url: url ?? this.state.url, missing: !url });
  }

  render({ decision, camera }, { url, missing }) {
    return html`
      <figure class="still" data-decision=${missing ? null : decision}>
        ${url && !missing
          ? html`<img src=${url} alt=${`${camera} camera as π_HL saw it`} />`
          : html`<p class="small">${missing ? "no picture" : "…"}</p>`}
        <figcaption>${camera}</figcaption>
      </figure>
    `;
  }
}
