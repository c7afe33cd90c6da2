// What a robot would make of a phrase, in a few words: known, new or refused.

/** read: the answer to `phrase`; null: not asked yet; unknown: why nobody could be asked. */
export function verdict(read) {
  if (!read) return { kind: "new", note: "asking the robot …" };
  if (read.unknown) return { kind: "new", note: "the robot can't be asked now" };
  if (read.refused) return { kind: "refused", note: "would be refused", reason: read.refused };
  if (read.known) return { kind: "known", note: "known" };
  return { kind: "new", note: `new to the low level · taken for “${read.means}”` };
}
