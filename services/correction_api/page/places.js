// Which phrase stands on which key: scores change several times a second, and neither a key nor a
// button may come to mean something else under the finger.
export const PLACES = 9;
const BEST = 5; // so many of the proposals always have a key

/** How long a key that has another phrase now doesn't act: it was meant for the one before. */
const SETTLE_MS = 700;

/**
 * The places after a decision: {episode, texts: [9], since: [9]}, null where nothing stands.
 *
 * Within an episode a phrase keeps its key, also when it isn't proposed any more; only one of the
 * best that has no key takes that of the least wanted. proposed: [{goal, score}], best first;
 * refused: the phrases that the robot could not do; now: in ms.
 */
export function arrange(before, episode, proposed, refused, now) {
  const scores = new Map(proposed.map(({ goal, score }) => [goal.text, score]));
  const stays = (text) => !refused.has(text) && (scores.has(text) || before.episode === episode);
  const old = before?.texts ?? Array(PLACES).fill(null);
  const texts = old.map((text) => (text !== null && stays(text) ? text : null));
  const ranked = [...scores.keys()].filter((text) => !refused.has(text));
  const best = ranked.slice(0, BEST);
  for (const text of ranked) {
    if (texts.includes(text)) continue;
    if (texts.includes(null)) texts[hole(texts, old)] = text;
    else if (best.includes(text)) texts[worst(texts, best, scores)] = text;
  }
  const same = (text, at) => old[at] === null || old[at] === text;
  const since = texts.map((text, at) => (same(text, at) ? (before?.since[at] ?? 0) : now));
  return { episode, texts, since };
}

/** A key that meant nothing before is better than one that did. */
function hole(texts, old) {
  const fresh = texts.findIndex((text, at) => text === null && old[at] === null);
  return fresh >= 0 ? fresh : texts.indexOf(null);
}

/** The place of the least wanted phrase that isn't one of the best. */
function worst(texts, best, scores) {
  const score = (at) => scores.get(texts[at]) ?? -1;
  return texts.reduce(
    (low, text, at) => (best.includes(text) || (low >= 0 && score(low) <= score(at)) ? low : at),
    -1,
  );
}

/** Whether a key got its phrase so lately that whoever presses it may mean the one before. */
export const unsettled = ({ since }, at, now) => now - since[at] < SETTLE_MS;

/** What is shown: up to the last place that is taken. */
export const taken = (places) =>
  places?.texts.slice(0, places.texts.findLastIndex((text) => text !== null) + 1) ?? [];
