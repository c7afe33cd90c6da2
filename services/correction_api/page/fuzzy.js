// Which known commands are meant by a few letters: word by word, with slips of the finger.
const LEADS = ["pick", "put", "up", "the", "it", "in", "on", "down", "a", "an", "into", "wait"];

export const wordsOf = (text) => text.toLowerCase().match(/[\p{L}\p{N}]+/gu) ?? [];

/** The things that a command is about and a prompt names. */
export function named(command, prompt) {
  const asked = new Set(wordsOf(prompt));
  return wordsOf(command).some((word) => !LEADS.includes(word) && asked.has(word));
}

/**
 * Known commands that fit what was typed, best first: [{text, inPrompt, score}]. Every word that
 * was typed must be found; what the prompt names goes before the rest.
 */
export function rank(typed, commands, prompt) {
  const words = wordsOf(typed);
  return commands
    .map((text, at) => {
      const inPrompt = named(text, prompt);
      return { text, inPrompt, score: score(words, wordsOf(text)) + (inPrompt ? 0.5 : 0), at };
    })
    .filter(({ score }) => score > 0 || !words.length)
    .sort((one, other) => other.score - one.score || one.at - other.at);
}

function score(words, known) {
  let sum = 0;
  for (const word of words) {
    const best = Math.max(...known.map((one) => alike(word, one)));
    if (best <= 0) return -1;
    sum += best;
  }
  return words.length ? sum / words.length : 0;
}

/** 0 (not alike) to 4 (the same). */
function alike(word, known) {
  if (word === known) return 4;
  if (known.startsWith(word)) return 3;
  if (word.length > 2 && known.includes(word)) return 2;
  if (word.length > 3 && slips(word, known) <= 1) return 1.5;
  return word.length > 1 && word[0] === known[0] && within(word, known) ? 1 : 0;
}

/** The letters of a word stand in another one, in order. */
function within(word, known) {
  let at = 0;
  for (const letter of known) if (letter === word[at]) at += 1;
  return at === word.length;
}

/** Letters to add, leave out, change or swap, to make a word the beginning of another one. */
function slips(word, known) {
  let before = null;
  let row = Array.from({ length: known.length + 1 }, (_, at) => at);
  for (let i = 1; i <= word.length; i++) {
    const next = [i];
    for (let j = 1; j <= known.length; j++) {
      const same = word[i - 1] === known[j - 1] ? 0 : 1;
      next[j] = Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + same);
      const swapped = i > 1 && word[i - 1] === known[j - 2] && word[i - 2] === known[j - 1];
      if (swapped && j > 1) next[j] = Math.min(next[j], before[j - 2] + 1);
    }
    [before, row] = [row, next];
  }
  return Math.min(...row.slice(Math.max(0, word.length - 1)));
}
