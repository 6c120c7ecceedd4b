import { outcomeColours, rgb, scaleColour } from './theme.js';

/** What a point's colour can stand for. */
export const COLOURINGS = [
  { key: 'outcome', name: 'outcome' },
  { key: 'range', name: 'range', unit: 'm' },
  { key: 'height', name: 'height', unit: 'm' },
];

const OUTCOMES_THAT_STAND_OUT = 3; // tp, fp, fn come first in the palette

/** The quantity per point that a scale shows. */
export function quantity(key, scan) {
  const { positions_m, points } = scan;
  const values = new Float32Array(points);
  for (let i = 0; i < points; ++i) {
    const [x, y, z] = [positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2]];
    values[i] = key === 'height' ? z : Math.hypot(x, y, z);
  }
  return values;
}

/** From the 2nd to the 98th percentile of the points that are drawn: a few far ones hide no detail. */
export function limits(values, drawable) {
  const sorted = values.filter((_, i) => drawable[i]).sort();
  if (sorted.length === 0) return [0, 1];
  const at = (fraction) => sorted[Math.min(sorted.length - 1, Math.floor(fraction * sorted.length))];
  const [low, high] = [at(0.02), at(0.98)];
  return high > low ? [low, high] : [low, low + 1];
}

function byOutcome(scan, theme) {
  const palette = outcomeColours(theme).map(rgb);
  const colours = new Uint8Array(3 * scan.points);
  for (let i = 0; i < scan.points; ++i) colours.set(palette[scan.outcomes[i]], 3 * i);
  return { colours, scale: null };
}

function byQuantity(key, scan) {
  const values = quantity(key, scan);
  const [low, high] = limits(values, scan.drawable);
  const steps = Array.from({ length: 256 }, (_, s) => scaleColour(s / 255));
  const colours = new Uint8Array(3 * scan.points);
  for (let i = 0; i < scan.points; ++i) {
    const fraction = Math.min(Math.max((values[i] - low) / (high - low), 0), 1);
    colours.set(steps[Math.round(255 * fraction)], 3 * i);
  }
  return { colours, scale: { low, high } };
}

/** Three bytes per point, and the scale when the colour is one. */
export function colourPoints(key, scan, theme) {
  return key === 'outcome' ? byOutcome(scan, theme) : byQuantity(key, scan);
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
