import { bars } from './chart.js';
import { count, fixed, percent } from './format.js';
import { OUTCOMES } from './theme.js';

const COLOURS = Object.fromEntries(OUTCOMES.map(({ key, light, dark }) => [key, { light, dark }]));

function binName({ from_m: from, to_m: to }) {
  if (from === null) return `below ${to} m`;
  return to === null ? `from ${from} m` : `${from} to ${to} m`;
}

function overBins(names) {
  return {
    xLabel: 'bin',
    xValue: (_, i) => names[i] ?? '–',
    xScale: { range: [-0.6, names.length - 0.4] },
    xAxis: { values: (_, ticks) => ticks.map((t) => (Number.isInteger(t) ? names[t]?.replace(' to ', '–').replace(' m', '') : '')), incrs: [1, 2, 4] },
  };
}

function outcomeBars(key, title, bins) {
  const names = bins.map(binName);
  // One bar per bin, its parts on top of each other: the highest is drawn first.
  const stacked = (keys) => bins.map((bin) => keys.reduce((sum, k) => sum + bin[k], 0));
  const part = (keys, label) => ({
    label, values: bins.map((bin) => bin[keys.at(-1)]), drawn: stacked(keys), colour: COLOURS[keys.at(-1)],
    fill: (stroke) => stroke, paths: bars, width: 0, points: { show: false },
  });
  return {
    key, title, note: 'points, metres', x: bins.map((_, i) => i),
    series: [part(['tp', 'fn', 'fp'], 'FP'), part(['tp', 'fn'], 'FN'), part(['tp'], 'TP')],
    options: { text: count, ...overBins(names) },
  };
}

export function rangeChart({ breakdown }) {
  const bins = breakdown?.by_range?.filter(({ tp, fp, fn, tn }) => tp + fp + fn + tn > 0);
  return bins?.length ? outcomeBars('range', 'Right and wrong by range', bins) : null;
}

/** Each object a dot: how far away it was and how much of it was found. */
export function objectsChart({ breakdown }) {
  const objects = breakdown?.objects ?? [];
  if (objects.length === 0) return null;
  const sorted = [...objects].sort((a, b) => a.mean_range_m - b.mean_range_m);
  return {
    key: 'objects',
    title: 'Recall per object',
    note: breakdown.object_count > objects.length ? `by mean range; the worst ${objects.length} of ${breakdown.object_count}` : 'by mean range',
    x: sorted.map((object) => object.mean_range_m),
    series: [{
      label: 'recall', values: sorted.map((object) => object.recall), colour: COLOURS.tp,
      paths: () => null, points: { show: true, size: 8 },
    }],
    options: {
      text: percent, xLabel: 'range', xValue: (_, v) => fixed(v, 1, 'm'), yScale: { range: [-0.04, 1.04] },
      yAxis: { values: (_, ticks) => ticks.map((t) => `${Math.round(100 * t)} %`) },
    },
  };
}
