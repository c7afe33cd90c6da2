// HTTP: everything below api/v1, relative to the page, so that it works below a path prefix.
import { borrow, spoil, token } from "./token.js";

export { token } from "./token.js";

const BASE = new URL("api/v1/", document.baseURI);

let refused = () => {};

/** Have `shut()` called whenever the service wants a token that this page doesn't have. */
export const onRefused = (shut) => (refused = shut);

/** An answer that says no; `detail` says what is wrong and what would be right. */
export class Problem extends Error {
  constructor(status, detail) {
    super(detail);
    this.status = status;
  }
}

/** No answer of the service's own, and why: it, or the way to it, may come back. */
class NoAnswer extends Error {}

export function socketUrl() {
  const url = new URL("live", BASE);
  url.protocol = url.protocol.replace("http", "ws");
  return url;
}

const PATIENCE_MS = 15_000; // Whoever does not answer within it hangs.

export const get = (path) => call("GET", path);

/** withinMs: after this it is given up, and can be sent again under the id that it has. */
export const post = (path, body, withinMs = PATIENCE_MS) =>
  call("POST", path, JSON.stringify(body), { withinMs });

/** Send sound as its type says; to recognise it takes a while on a busy machine. */
export const postSound = (path, type, sound) =>
  call("POST", path, sound, { type, withinMs: 4 * PATIENCE_MS });

async function call(method, path, body, options = {}) {
  const { type = "application/json", withinMs = PATIENCE_MS } = options;
  const headers = body ? { "Content-Type": type } : {};
  const sent = token.get();
  if (sent) headers.Authorization = `Bearer ${sent}`;
  const signal = AbortSignal.timeout(withinMs);
  const answer = await told(fetch(new URL(path, BASE), { method, headers, body, signal }));
  if (answer.status === 401) {
    if (token.get() !== sent || (await borrow())) return call(method, path, body, options);
    spoil();
    refused();
  }
  const content = answer.status === 204 ? null : await told(answer.json());
  if (!answer.ok) throw new Problem(answer.status, content.detail);
  return content;
}

/** What a browser says of a network is for nobody; a proxy that answers instead sends no JSON. */
async function told(coming) {
  try {
    return await coming;
  } catch ({ name }) {
    const why = name === "TimeoutError" ? "does not answer" : "cannot be reached";
    throw new NoAnswer(`the service ${why}`);
  }
}

/** A fresh id that the server accepts; also where crypto.randomUUID is missing (plain http). */
export function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(8));
  return "page-" + [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
