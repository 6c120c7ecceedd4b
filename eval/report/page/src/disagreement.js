import { OUTCOMES, rgb } from './theme.js';

const MOVES = [true, true, false, false, false, true]; // whether the run calls a point of this outcome moving

/** What two runs say of a point: the first one, and another. */
const OPINIONS = ['tp', 'fp', 'unlabelled_moving', 'tn'].map((key) => OUTCOMES.find((outcome) => outcome.key === key));
const BOTH_MOVING = 0, FIRST_ALONE = 1, OTHER_ALONE = 2, BOTH_STATIC = 3;

export function isDisputed(opinion) {
  return opinion === FIRST_ALONE || opinion === OTHER_ALONE;
}

/**
 * One opinion per point of a pane. The first pane holds the first run against all others together: where any of
 * them disagrees, that counts. A run that was not scored in this scan has no opinion.
 */
export function opinionsOf(scans, pane) {
  const [first, ...others] = scans;
  const against = (pane === 0 ? others : [scans[pane]]).filter(({ unscored }) => !unscored);
  if (first.unscored || against.length === 0) return new Uint8Array(first.outcomes.length).fill(BOTH_STATIC);
  return Uint8Array.from(first.outcomes, (outcome, i) => {
    const moves = MOVES[outcome];
    if (against.every(({ outcomes }) => MOVES[outcomes[i]] === moves)) return moves ? BOTH_MOVING : BOTH_STATIC;
    return moves ? FIRST_ALONE : OTHER_ALONE;
  });
}

/** Three bytes per point. */
export function opinionColours(opinions, theme) {
  const palette = OPINIONS.map((outcome) => rgb(outcome[theme]));
  const colours = new Uint8Array(3 * opinions.length);
  opinions.forEach((opinion, i) => colours.set(palette[opinion], 3 * i));
  return colours;
}

/** The key to the colours: [{name, colour}]. */
export function opinionNames([first, ...others], theme) {
  const other = others.length === 1 ? others[0] : 'the other';
  const names = ['moving in both', `moving in ${first} alone`, `moving in ${other} alone`, 'static in both'];
  return names.map((name, i) => ({ name, colour: OPINIONS[i][theme] }));
}

/** How many points only the first run calls moving, and how many only another. */
export function countDisputed(opinions) {
  const counts = [0, 0, 0, 0];
  for (const opinion of opinions) ++counts[opinion];
  return { first: counts[FIRST_ALONE], other: counts[OTHER_ALONE] };
}
