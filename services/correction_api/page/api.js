// HTTP: everything below api/v1, relative to the page, so that it works below a path prefix.
const BASE = new URL("api/v1/", document.baseURI);
const TOKEN = "hld-token";

export const token = {
  get: () => sessionStorage.getItem(TOKEN),
  set: (value) => sessionStorage.setItem(TOKEN, value),
};

/** An answer that says no; `detail` says what is wrong and what would be right. */
export class Problem extends Error {
  constructor(status, detail) {
    super(detail);
    this.status = status;
  }
}

export function socketUrl() {
  const url = new URL("live", BASE);
  url.protocol = url.protocol.replace("http", "ws");
  return url;
}

export const get = (path) => call("GET", path);
export const post = (path, body) => call("POST", path, body);

async function call(method, path, body) {
  const headers = body ? { "Content-Type": "application/json" } : {};
  if (token.get()) headers.Authorization = `Bearer ${token.get()}`;
  const answer = await fetch(new URL(path, BASE), {
    method,
    headers,
    body: body && JSON.stringify(body),
  });
  const content = answer.status === 204 ? null : await answer.json();
  if (!answer.ok) throw new Problem(answer.status, content.detail);
  return content;
}

/** A fresh id that the server accepts; also where crypto.randomUUID is missing (plain http). */
export function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(8));
  return "page-" + [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}
