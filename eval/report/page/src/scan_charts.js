import { count, fixed, intervalOf, percent, whyNoInterval } from './format.js';
import { hasCounts, iou, precision, recall } from './metrics.js';
import { OUTCOMES, SERIES } from './theme.js';

const COLOURS = Object.fromEntries(OUTCOMES.map(({ key, light, dark }) => [key, { light, dark }]));
const NEUTRAL = { light: '#5d6774', dark: '#97a3b2' };

/** A number of every scan with truth, null for the others. */
export function ofJudged(scans, number) {
  return scans.map((scan) => (hasCounts(scan) ? number(scan) : null));
}

export function percentAxis() {
  return { yScale: { range: [-0.02, 1.02] }, yAxis: { values: (_, ticks) => ticks.map((t) => `${Math.round(100 * t)} %`) } };
}

function flat(scans, value) {
  return scans.map(() => value);
}

/** IoU, precision and recall of every scan; the IoU of the whole, with its interval when known. */
export function metricsChart({ result, estimates }) {
  const { scans, summary } = result;
  if (!summary) return null;
  const mean = summary.iou;
  const interval = intervalOf(estimates?.iou);
  const series = [
    { label: 'IoU', values: ofJudged(scans, iou), colour: COLOURS.tp, width: 2 },
    { label: 'precision', values: ofJudged(scans, precision), colour: COLOURS.fp },
    { label: 'recall', values: ofJudged(scans, recall), colour: COLOURS.unlabelled_moving },
    { label: 'IoU of all', values: flat(scans, mean), colour: NEUTRAL, dash: [6, 4], points: { show: false } },
  ];
  const bands = [];
  if (interval) {
    const edge = { colour: NEUTRAL, width: 0.5, points: { show: false } };
    series.push({ label: '95 % from', values: flat(scans, interval[0]), ...edge }, { label: 'to', values: flat(scans, interval[1]), ...edge });
    bands.push({ series: [6, 5], fill: 'rgb(120 130 145 / 20%)' });
  }
  return {
    key: 'metrics',
    title: 'IoU, precision, recall',
    note: interval ? 'the band is the 95 % interval of the whole' : ['the dashed line is the whole', whyNoInterval(estimates?.iou)].filter(Boolean).join('; '),
    series,
    options: { text: percent, bands, ...percentAxis() },
  };
}

export function countsChart({ result }) {
  if (!result.summary) return null;
  const of = (key, label) => ({ label, values: ofJudged(result.scans, (scan) => scan[key]), colour: COLOURS[key] });
  return { key: 'counts', title: 'Moving points', series: [of('tp', 'TP'), of('fp', 'FP'), of('fn', 'FN')], options: { text: count } };
}

/**
 * Title and note of a chart of the thresholds, by their name in the method; null where the runs have none of one
 * kind, or where it is the same for all scans: then it is a setting.
 */
export function thresholdFrame(entries) {
  const [{ threshold_name: name, score_name: score }] = entries;
  if (!name || entries.some((entry) => entry.threshold_name !== name)) return null;
  const varies = ({ result }) => new Set(result.scans.map(({ threshold }) => threshold ?? null).filter((t) => t !== null)).size > 1;
  if (!entries.some(varies)) return null;
  const title = name[0].toUpperCase() + name.slice(1);
  return { key: 'threshold', title, note: `of the ${score}; none where no motion was looked for`, options: { text: (v) => fixed(v, 1) } };
}

export function thresholdChart(entry) {
  const frame = thresholdFrame([entry]);
  const values = entry.result.scans.map(({ threshold }) => threshold ?? null);
  return frame && { ...frame, series: [{ label: 'threshold', values, colour: COLOURS.unlabelled_moving }] };
}

/** Rows of timing.scans as columns by name. */
export function costColumns({ timing }) {
  if (!timing?.scan_columns) return null;
  return Object.fromEntries(timing.scan_columns.map((name, c) => [name, timing.scans.map((row) => row[c])]));
}

/** Stages on top of each other, so that their upper edge is the whole scan. */
export function stagesChart({ result }) {
  const columns = costColumns(result);
  if (!columns) return null;
  const names = Object.keys(columns).filter((name) => name.endsWith('_ms') && name !== 'read_ms' && name !== 'push_ms');
  const below = new Array(result.scans.length).fill(0);
  const series = names.map((name, s) => {
    columns[name].forEach((ms, k) => (below[k] += ms));
    return {
      label: name.slice(0, -3).replace('_', ' '),
      values: columns[name],
      drawn: [...below],
      colour: SERIES[s % SERIES.length],
      fill: (stroke) => stroke,
      width: 0,
      points: { show: false },
    };
  });
  series.reverse(); // each fills down to zero, so the highest goes first
  return {
    key: 'stages',
    title: 'Time per stage',
    note: 'milliseconds, stacked',
    series,
    options: { text: (v) => fixed(v, 1, 'ms'), yScale: { range: (_, __, high) => [0, 1.05 * high] } },
  };
}

export function memoryChart({ result }) {
  const columns = costColumns(result);
  if (!columns?.resident_mib) return null;
  return {
    key: 'memory',
    title: 'Memory',
    note: 'resident after each scan, MiB',
    series: [{ label: 'resident', values: columns.resident_mib, colour: COLOURS.tp }],
    options: { text: (v) => fixed(v, 0, 'MiB') },
  };
}
