import { isDisputed, opinionColours, opinionsOf } from './disagreement.js';
import { OUTCOMES, outcomeColours, REASONS, rgb, scaleColour } from './theme.js';

/** What a point's colour can stand for. */
export const COLOURINGS = [
  { key: 'outcome', name: 'outcome' },
  { key: 'range', name: 'range', unit: 'm', digits: 1 },
  { key: 'height', name: 'height', unit: 'm', digits: 1 },
  { key: 'velocity', name: 'radial velocity', unit: 'm/s', digits: 1 },
  { key: 'score', name: 'score', unit: '' },
  { key: 'reason', name: 'reason' },
  { key: 'disagreement', name: 'disagreement' },
];

const OUTCOMES_THAT_STAND_OUT = 3; // tp, fp, fn come first in the palette
const LARGER = 1.8;

/** Why a colouring cannot be shown; null where it can. Scores of different methods have no common scale. */
function obstacle(key, clouds, results, view) {
  if (key === 'score') {
    if (!results.every((result) => clouds.hasScores(result))) return 'needs mosbench run --write scores';
    const kinds = new Set(results.map((result) => clouds.scoreKind(result)));
    return kinds.size > 1 ? 'not of different methods' : null;
  }
  if (key === 'velocity') return results.every((result) => clouds.hasVelocities(result)) ? null : 'not in every recording';
  if (key === 'reason') return results.every((result) => clouds.hasReasons(result)) ? null : 'not given by every run';
  if (key !== 'disagreement') return null;
  return results.length < 2 ? 'needs a run beside' : view === 'map' ? 'not in the motion map' : null;
}

/** Every colouring with its name for the shown results, and with `why` where it cannot be shown. */
export function allColourings(clouds, results, view) {
  const several = results.length > 1 || clouds.comparable(results[0]).length > 0;
  const reasoned = results.some((result) => clouds.hasReasons(result));
  const measured = results.some((result) => clouds.hasVelocities(result));
  const offered = { disagreement: several, reason: reasoned, velocity: measured };
  return COLOURINGS.filter(({ key }) => offered[key] ?? true).map((colouring) => ({
    ...colouring,
    name: colouring.key === 'score' ? clouds.scoreName(results[0]) : colouring.name,
    why: obstacle(colouring.key, clouds, results, view),
  }));
}

/** Those that the shown results and the view allow. */
export function colouringsOf(clouds, results, view) {
  return allColourings(clouds, results, view).filter(({ why }) => why === null);
}

/** Colour of points without a score, which are most, or without a velocity. */
export function colourWithoutScore(theme) {
  return OUTCOMES.find(({ key }) => key === 'unlabelled')[theme];
}

/** The quantity per point that a scale shows. */
export function quantity(key, scan) {
  if (key === 'score') return Float32Array.from(scan.scores);
  if (key === 'velocity') return scan.velocities_m_s;
  const { positions_m, points } = scan;
  const values = new Float32Array(points);
  for (let i = 0; i < points; ++i) {
    const [x, y, z] = [positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2]];
    values[i] = key === 'height' ? z : Math.hypot(x, y, z);
  }
  return values;
}

/** From the 2nd to the 98th percentile: a few far points hide no detail. */
export function limits(values) {
  const sorted = values.slice().sort();
  if (sorted.length === 0) return [0, 1];
  const at = (fraction) => sorted[Math.min(sorted.length - 1, Math.floor(fraction * sorted.length))];
  const [low, high] = [at(0.02), at(0.98)];
  return high > low ? [low, high] : [low, low + 1];
}

/** One scale for all that is shown, so that equal colours are equal numbers. Votes are counted from 1. */
function commonScale(key, scans, values) {
  const shown = values.map((v, s) => v.filter((x, i) => scans[s].drawable[i] && !Number.isNaN(x) && (key !== 'score' || x !== 0)));
  const ends = shown.map(limits);
  const [low, high] = [Math.min(...ends.map(([lowest]) => lowest)), Math.max(...ends.map(([, highest]) => highest))];
  if (key !== 'score') return { low, high };
  const areVotes = shown.every((v) => v.every((x) => Number.isInteger(x) && x > 0));
  return areVotes ? { low: 1, high: Math.max(2, high), digits: 0 } : { low, high, digits: 2 };
}

function byKind(kinds, hexColours) {
  const palette = hexColours.map(rgb);
  const colours = new Uint8Array(3 * kinds.length);
  for (let i = 0; i < kinds.length; ++i) colours.set(palette[kinds[i]], 3 * i);
  return colours;
}

/** The key to the colours of reasons: [{name, colour}]. */
export function reasonNames(theme) {
  return REASONS.map((reason) => ({ name: reason.name, colour: reason[theme] }));
}

function byScale(values, { low, high }, theme, isNone) {
  const none = rgb(colourWithoutScore(theme));
  const steps = Array.from({ length: 256 }, (_, s) => scaleColour(s / 255, theme));
  const colours = new Uint8Array(3 * values.length);
  for (let i = 0; i < values.length; ++i) {
    const fraction = Math.min(Math.max((values[i] - low) / (high - low), 0), 1);
    colours.set(isNone(values[i]) ? none : steps[Math.round(255 * fraction)], 3 * i);
  }
  return colours;
}

/** Three bytes per point of each scan, the scale when the colour is one, and `large(p, i)`: what stands out. */
export function colourScans(key, scans, theme) {
  const large = (p, i) => scans[p].outcomes[i] < OUTCOMES_THAT_STAND_OUT;
  if (scans.length === 0) return { colours: [], scale: null, large };
  if (key === 'outcome') return { colours: scans.map((scan) => byKind(scan.outcomes, outcomeColours(theme))), scale: null, large };
  if (key === 'reason') {
    const hexColours = reasonNames(theme).map(({ colour }) => colour);
    return { colours: scans.map((scan) => byKind(scan.reasons, hexColours)), scale: null, large };
  }
  if (key === 'disagreement') {
    const opinions = scans.map((_, p) => opinionsOf(scans, p));
    return { colours: opinions.map((o) => opinionColours(o, theme)), scale: null, opinions, large: (p, i) => isDisputed(opinions[p][i]) };
  }
  const values = scans.map((scan) => quantity(key, scan));
  const scale = commonScale(key, scans, values);
  const isNone = key === 'score' ? (value) => value === 0 : Number.isNaN;
  return { colours: values.map((v) => byScale(v, scale, theme, isNone)), scale, large };
}

/** Size per point in pixels: 0 for what is hidden or has no position, larger for what stands out. */
export function sizePoints(scan, visible, pixels, large) {
  return Float32Array.from(scan.outcomes, (outcome, i) => {
    if (!scan.drawable[i] || !visible[outcome]) return 0;
    return large(i) ? LARGER * pixels : pixels;
  });
}

/** How many points of each outcome there are, drawn or not. */
export function countOutcomes(outcomes) {
  const counts = [0, 0, 0, 0, 0, 0];
  for (const outcome of outcomes) ++counts[outcome];
  return counts;
}
