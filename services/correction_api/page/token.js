// The token of this tab, for as long as the tab is open. A new tab asks those that are open for theirs,
// so that nothing is kept on disk, and no browser sends along by itself what lets one in.
const TOKEN = "hld-token";
const ANSWER_MS = 1000; // So long all open tabs have to answer; they do at once, unless they are busy.

/** Tabs of this service alone hear each other: of its origin, and of its path below that. */
const tabs = new BroadcastChannel(`${TOKEN} ${new URL(".", document.baseURI).pathname}`);

let good = true; // until the service refuses it
let heard = null; // takes the tokens of other tabs, while they are asked
let asking = null;

export const token = {
  get: () => sessionStorage.getItem(TOKEN),
  set: (value) => sessionStorage.setItem(TOKEN, value),
};

tabs.onmessage = ({ data }) => {
  if (data.wanted && good && token.get()) tabs.postMessage({ token: token.get() });
  if (data.token) heard?.(data.token);
};

/** The service refuses this tab's token: it is none for another tab. */
export const spoil = () => (good = false);

/** Take the token of the open tabs, if this one has none; whether it has one now. Where they have
 *  several, nobody knows who sits before this one. */
export function borrow() {
  if (token.get()) return Promise.resolve(false);
  asking ??= ask().finally(() => (asking = null));
  return asking;
}

const after = (ms) => new Promise((resume) => setTimeout(resume, ms));

async function ask() {
  const answers = new Set();
  heard = (found) => answers.add(found);
  tabs.postMessage({ wanted: true });
  await after(ANSWER_MS); // Even if one has answered: another may have another token.
  heard = null;
  const [found, ...others] = answers;
  if (!found || others.length) return false;
  token.set(found);
  return true;
}
