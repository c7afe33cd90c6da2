// What a robot could not do in its scene, as it says itself: proposals that would only earn a
// refusal get no key. The scene stays the same within an episode, so each phrase is asked about once.
import { get } from "./api.js";

const scenes = {}; // by robot: {episode, asked, refused}, both sets of phrases
const commands = {}; // by robot: those that it said last that it could do

/** What it could not do, as far as that is known. */
export function refused({ robot, episode }) {
  if (scenes[robot]?.episode !== episode) {
    scenes[robot] = { episode, asked: new Set(), refused: new Set() };
  }
  return scenes[robot].refused;
}

/** The commands that it could do, as it said last. */
export const listed = (robot) => commands[robot] ?? [];

/** Ask about proposals that were not asked about yet; `found()` is called when some are refused. */
export async function inquire(view, found) {
  refused(view);
  const scene = scenes[view.robot];
  const proposed = view.decision.proposed.map(({ goal }) => goal.text);
  const texts = proposed.filter((text) => !scene.asked.has(text));
  if (!texts.length) return;
  for (const text of texts) scene.asked.add(text);
  try {
    const doubtful = await unlisted(view.robot, texts);
    const answers = await Promise.all(doubtful.map((text) => get(question(view.robot, text))));
    const bad = doubtful.filter((_, at) => answers[at].refused);
    for (const text of bad) scene.refused.add(text);
    if (bad.length) found();
  } catch {
    for (const text of texts) scene.asked.delete(text); // The next decision asks again.
  }
}

const question = (robot, text) => `robots/${robot}/phrase?text=${encodeURIComponent(text)}`;

/** Those that are none of the commands that it says it could do. */
async function unlisted(robot, texts) {
  const told = await get(`robots/${robot}/commands`);
  commands[robot] = told.commands;
  if (!told.asked) throw new Error(`${robot} can't be asked now`);
  return texts.filter((text) => !told.commands.includes(text));
}
