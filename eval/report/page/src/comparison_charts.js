import { count, fixed, percent } from './format.js';
import { iou, precision, recall } from './metrics.js';
import { costColumns, ofJudged, percentAxis } from './scan_charts.js';
import { OUTCOMES } from './theme.js';

const colourOf = (key) => OUTCOMES.find((outcome) => outcome.key === key);
// Told apart by any colour vision, and by their dashes.
const LINES = [{ colour: colourOf('tp'), width: 2 }, { colour: colourOf('fp'), dash: [7, 3], width: 2 }];

/** The runs' names, told apart when they are the same. */
export function runNames(entries) {
  const names = entries.map(({ run }) => run);
  return names[0] === names[1] ? names.map((name, i) => `${name} (${i + 1})`) : names;
}

/** One line per run, or null when a run lacks the numbers. */
function chart(entries, { key, title, note, values, options }) {
  const lines = entries.map(values);
  if (lines.includes(null)) return null;
  const series = runNames(entries).map((label, i) => ({ label, values: lines[i], ...LINES[i] }));
  return { key, title, note, series, options };
}

function metricChart(entries, key, title, metric, note) {
  const values = ({ result }) => (result.summary ? ofJudged(result.scans, metric) : null);
  return chart(entries, { key, title, note, values, options: { text: percent, ...percentAxis() } });
}

function countChart(entries, key, title) {
  const values = ({ result }) => (result.summary ? ofJudged(result.scans, (scan) => scan[key]) : null);
  return chart(entries, { key, title, note: 'points', values, options: { text: count } });
}

function costChart(entries, column, key, title, note, text) {
  const values = ({ result }) => costColumns(result)?.[column] ?? null;
  return chart(entries, { key, title, note, values, options: { text } });
}

/** The charts over the scans for two runs of the same scans. */
export function comparisonCharts(entries) {
  const whole = entries.map(({ result }) => percent(result.summary?.iou)).join(' and ');
  return [
    metricChart(entries, 'iou', 'IoU', iou, `of the whole ${whole}`),
    metricChart(entries, 'precision', 'Precision', precision),
    metricChart(entries, 'recall', 'Recall', recall),
    countChart(entries, 'fp', 'False positives'),
    countChart(entries, 'fn', 'False negatives'),
    costChart(entries, 'push_ms', 'time', 'Time of the method', 'milliseconds per scan', (v) => fixed(v, 1, 'ms')),
    costChart(entries, 'resident_mib', 'memory', 'Memory', 'resident after each scan, MiB', (v) => fixed(v, 0, 'MiB')),
    chart(entries, {
      key: 'threshold', title: 'Otsu threshold', note: 'of the dynamic score', options: { text: (v) => fixed(v, 1) },
      values: ({ result }) => result.scans.map(({ threshold }) => threshold ?? null),
    }),
  ].filter(Boolean);
}
