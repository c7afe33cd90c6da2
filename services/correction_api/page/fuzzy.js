// Which known commands are meant by a few letters: word by word, with slips of the finger.
const LEADS = ["pick", "put", "up", "the", "it", "in", "on", "down", "a", "an", "into", "wait"];

const GUESSED = 0.75; // how alike a short word and one with a slip in it are

export const wordsOf = (text) => text.toLowerCase().match(/[\p{L}\p{N}]+/gu) ?? [];

/** The things that a command is about and a prompt names. */
export function named(command, prompt) {
  const asked = new Set(wordsOf(prompt));
  return things(command).some((word) => asked.has(word));
}

const things = (command) => wordsOf(command).filter((word) => !LEADS.includes(word));

/**
 * Known commands that fit what was typed, best first: [{text, inPrompt, score, guessed}]. Every word
 * that was typed must be found; what the prompt names goes before the rest. A slip in a word that
 * leads to the thing ("teh bread") is made good only where the thing itself was typed, too: else "che"
 * would mean "the", and so every command. guessed: a slip in a short word was made good, which may as
 * well be another word.
 */
export function rank(typed, commands, prompt) {
  const words = wordsOf(typed);
  return commands
    .map((text, at) => {
      const inPrompt = named(text, prompt);
      const about = things(text);
      const sure = !about.length || words.some((word) => about.some((one) => alike(word, one) > 0));
      const likes = words.map((word) => likest(word, wordsOf(text), sure));
      const guessed = likes.includes(GUESSED);
      return { text, inPrompt, score: mean(likes) + (inPrompt ? 0.5 : 0), at, guessed };
    })
    .filter(({ score }) => score > 0 || !words.length)
    .sort((one, other) => other.score - one.score || one.at - other.at);
}

const likest = (word, known, sure) =>
  Math.max(...known.map((one) => alike(word, one, sure || !LEADS.includes(one))));

function mean(likes) {
  if (likes.includes(0)) return -1;
  return likes.length ? likes.reduce((sum, like) => sum + like) / likes.length : 0;
}

/** 0 (not alike) to 4 (the same). slipping: whether a slip of the finger is made good. */
function alike(word, known, slipping = true) {
  if (word === known) return 4;
  if (known.startsWith(word)) return 3;
  if (word.length > 2 && known.includes(word)) return 2;
  if (slipping && word.length > 3 && slips(word, known) <= 1) return 1.5;
  if (word.length > 1 && word[0] === known[0] && within(word, known)) return 1;
  const short = slipping && word.length === 3 && known.length > 2;
  return short && slips(word, known, true) <= 1 ? GUESSED : 0;
}

/** The letters of a word stand in another one, in order. */
function within(word, known) {
  let at = 0;
  for (const letter of known) if (letter === word[at]) at += 1;
  return at === word.length;
}

/** Letters to add, leave out, change or swap, to make a word another one, or its beginning. */
function slips(word, known, whole = false) {
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
  return whole ? row.at(-1) : Math.min(...row.slice(Math.max(0, word.length - 1)));
}
