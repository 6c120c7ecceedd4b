import { OUTCOMES, outcomeColours, rgb, scaleColour } from './theme.js';

/** What a point's colour can stand for. */
export const COLOURINGS = [
  { key: 'outcome', name: 'outcome' },
  { key: 'range', name: 'range', unit: 'm', digits: 1 },
  { key: 'height', name: 'height', unit: 'm', digits: 1 },
  { key: 'score', name: 'dynamic score', unit: '', digits: 0 },
];

const OUTCOMES_THAT_STAND_OUT = 3; // tp, fp, fn come first in the palette

/** Those that the shown results allow: dynamic scores are only there when every run kept them. */
export function colouringsOf(clouds, results) {
  return COLOURINGS.filter(({ key }) => key !== 'score' || results.every((result) => clouds.hasScores(result)));
}

/** Colour of points without any vote for motion, which are most. */
export function colourWithoutScore(theme) {
  return OUTCOMES.find(({ key }) => key === 'unlabelled')[theme];
}

/** The quantity per point that a scale shows. */
export function quantity(key, scan) {
  if (key === 'score') return Float32Array.from(scan.scores);
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

/** One scale for all that is shown, so that equal colours are equal numbers. */
function commonScale(key, scans, values) {
  const ends = values.map((v, s) => limits(v.filter((x, i) => scans[s].drawable[i] && (key !== 'score' || x > 0))));
  const low = key === 'score' ? 1 : Math.min(...ends.map(([lowest]) => lowest));  // without a score: a colour of its own
  return { low, high: Math.max(key === 'score' ? 2 : -Infinity, ...ends.map(([, highest]) => highest)) };
}

function byOutcome(scan, theme) {
  const palette = outcomeColours(theme).map(rgb);
  const colours = new Uint8Array(3 * scan.points);
  for (let i = 0; i < scan.points; ++i) colours.set(palette[scan.outcomes[i]], 3 * i);
  return colours;
}

function byScale(values, { low, high }, theme, colourOfZero) {
  const steps = Array.from({ length: 256 }, (_, s) => scaleColour(s / 255, theme));
  const colours = new Uint8Array(3 * values.length);
  for (let i = 0; i < values.length; ++i) {
    const fraction = Math.min(Math.max((values[i] - low) / (high - low), 0), 1);
    colours.set(colourOfZero && values[i] === 0 ? colourOfZero : steps[Math.round(255 * fraction)], 3 * i);
  }
  return colours;
}

/** Three bytes per point of each scan, and the scale when the colour is one. */
export function colourScans(key, scans, theme) {
  if (key === 'outcome') return { colours: scans.map((scan) => byOutcome(scan, theme)), scale: null };
  const values = scans.map((scan) => quantity(key, scan));
  const scale = commonScale(key, scans, values);
  const colourOfZero = key === 'score' ? rgb(colourWithoutScore(theme)) : null;
  return { colours: values.map((v) => byScale(v, scale, theme, colourOfZero)), scale };
}

/** Size per point in pixels: 0 for what is hidden or has no position, false points larger. */
export function sizePoints(scan, visible, pixels) {
  return Float32Array.from(scan.outcomes, (outcome, i) => {
    if (!scan.drawable[i] || !visible[outcome]) return 0;
    return outcome < OUTCOMES_THAT_STAND_OUT ? 1.8 * pixels : pixels;
  });
}

/** How many points of each outcome there are, drawn or not. */
export function countOutcomes(outcomes) {
  const counts = [0, 0, 0, 0, 0, 0];
  for (const outcome of outcomes) ++counts[outcome];
  return counts;
}
