import { count, fixed, percent } from './format.js';
import { iou, precision, recall } from './metrics.js';
import { runNames } from './runs_menu.js';
import { costColumns, ofJudged, percentAxis, thresholdFrame } from './scan_charts.js';
import { runLine } from './theme.js';

/** One line per run, or null when a run lacks the numbers. */
function chart(entries, { key, title, note, values, options }) {
  const lines = entries.map(values);
  if (lines.includes(null)) return null;
  const series = runNames(entries).map((label, i) => ({ label, values: lines[i], ...runLine(i) }));
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

/** Of methods whose thresholds are of one kind; others have no common axis. */
function thresholdChart(entries) {
  const frame = thresholdFrame(entries);
  const values = ({ result }) => result.scans.map(({ threshold }) => threshold ?? null);
  return frame && chart(entries, { ...frame, values });
}

/** The charts over the scans for some runs of the same scans. */
export function comparisonCharts(entries) {
  const whole = entries.map(({ result }) => percent(result.summary?.iou)).join(', ');
  return [
    metricChart(entries, 'iou', 'IoU', iou, `of the whole ${whole}`),
    metricChart(entries, 'precision', 'Precision', precision),
    metricChart(entries, 'recall', 'Recall', recall),
    countChart(entries, 'fp', 'False positives'),
    countChart(entries, 'fn', 'False negatives'),
    costChart(entries, 'push_ms', 'time', 'Time of the method', 'milliseconds per scan', (v) => fixed(v, 1, 'ms')),
    costChart(entries, 'resident_mib', 'memory', 'Memory', 'resident after each scan, MiB', (v) => fixed(v, 0, 'MiB')),
    thresholdChart(entries),
  ].filter(Boolean);
}
