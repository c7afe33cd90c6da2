// What a robot could not do in its scene, as it says itself: proposals that would only earn a
// refusal get no key. The scene stays the same within an episode, so each phrase is asked about once;
// one after the other, so that what a person asks meanwhile is soon answered.
import { get } from "./api.js";

const scenes = {}; // by robot: {episode, asked, refused, busy}: two sets of phrases
const commands = {}; // by robot: those that it said last that it could do

/** What it could not do, as far as that is known. */
export function refused({ robot, episode }) {
  if (scenes[robot]?.episode !== episode) {
    scenes[robot] = { episode, asked: new Set(), refused: new Set(), busy: false };
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
  if (!texts.length || scene.busy) return;
  scene.busy = true;
  try {
    const doubtful = await unlisted(view.robot, texts);
    for (const text of texts) if (!doubtful.includes(text)) scene.asked.add(text);
    for (const text of doubtful) {
      const answer = await get(question(view.robot, text));
      scene.asked.add(text);
      if (!answer.refused) continue;
      scene.refused.add(text);
      found();
    }
  } catch {
    // With the next news of the robot it is asked again about what was not answered.
  } finally {
    scene.busy = false;
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
