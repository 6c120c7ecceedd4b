import { Chart } from './chart.js';
import { block, element, table } from './dom.js';
import { fixed, percent, rulesText } from './format.js';
import { readContent } from './payload.js';
import { State } from './state.js';
import { preferredTheme, runLine } from './theme.js';

const METRICS = { iou: 'IoU', precision: 'Precision', recall: 'Recall' };
const PERCENT_TICKS = (_, values) => values.map((v) => `${Math.round(100 * v)} %`);

/** "62.3 % (60.1 to 64.4)" of a mean with its interval. */
function meanText({ value, low, high }) {
  const interval = low === null ? '' : ` (${(100 * low).toFixed(1)} to ${(100 * high).toFixed(1)})`;
  return percent(value) + interval;
}

/** The unit of an axis; a probability has none to show. */
const unitOf = ({ unit }) => (unit === '1' ? '' : unit);

/** 1, 2 and 5 times powers of ten from `low` to `high`: uPlot begins a logarithmic axis at its end. */
export function logTicks(low, high) {
  const powers = Array.from({ length: 16 }, (_, i) => i - 6);
  return powers.flatMap((power) => [1, 2, 5].map((digit) => Number(`${digit}e${power}`))).filter((tick) => low <= tick && tick <= high);
}

/** Settings have no unit; a disturbance has one, a probability that of 1. */
const isSetting = ({ unit }) => unit === '';

/**
 * A metric over the strengths of one disturbance or the values of a setting, a line per method; bars are intervals. A
 * setting's default is a dot apart: methods and data sets have their own, which lie anywhere among the values.
 */
export function curveChart(curve, metric) {
  const places = curve.values.map((_, i) => i);
  const valuesOf = ({ points }) => points.map((point) => point[metric].value);
  return {
    key: `${curve.axis}-${metric}`,
    title: `${METRICS[metric]} by ${curve.axis}`,
    note: unitOf(curve),
    x: places,
    series: curve.lines.map((line, i) => ({
      label: line.label, values: valuesOf(line), points: { show: true, size: 6 }, ...runLine(i),
      ...(isSetting(curve) && { drawn: valuesOf(line).map((value, place) => (place === 0 ? null : value)) }),
    })),
    options: {
      text: percent, xLabel: curve.axis, xValue: (_, i) => curve.values[i] ?? '–',
      xScale: { range: [-0.3, places.length - 0.7] },
      xAxis: { incrs: [1], values: (_, ticks) => ticks.map((i) => curve.values[i] ?? '') },
      yScale: { range: [0, 1.02] }, yAxis: { values: PERCENT_TICKS },
      marks: isSetting(curve) ? curve.lines.map((line, i) => ({ x: 0, y: valuesOf(line)[0], colour: runLine(i).colour })) : undefined,
      // Side by side, or the last would hide the others.
      whiskers: curve.lines.flatMap(({ points }, i) => points.map((point, place) => ({
        x: place + 0.05 * (i - (curve.lines.length - 1) / 2), low: point[metric].low, high: point[metric].high, colour: runLine(i).colour,
      }))),
    },
  };
}

/** IoU over the time of a scan, a dot per method; null without times. */
export function paretoChart(rows) {
  const known = rows.map((row, i) => ({ ...row, line: runLine(i) })).filter((row) => row.ms_per_scan !== null && row.metrics.iou.value !== null);
  if (known.length === 0) return null;
  const sorted = [...known].sort((a, b) => a.ms_per_scan - b.ms_per_scan);
  return {
    key: 'pareto',
    title: 'IoU over time',
    note: 'ms per scan; * is on the Pareto front',
    x: sorted.map((row) => row.ms_per_scan),
    series: known.map((row) => ({
      label: row.label + (row.front ? ' *' : ''), values: sorted.map((other) => (other === row ? row.metrics.iou.value : null)),
      ...row.line, points: { show: true, size: 10 },
    })),
    options: {
      text: percent, xLabel: 'ms per scan', xScale: { distr: 3, range: [sorted[0].ms_per_scan / 2, sorted.at(-1).ms_per_scan * 2] }, yScale: { range: [0, 1.02] }, yAxis: { values: PERCENT_TICKS },
      xValue: (_, v) => fixed(v, 1), xAxis: {
        splits: (_, axis, low, high) => logTicks(low, high), filter: (_, ticks) => ticks, values: (_, ticks) => ticks.map(String),
      },
    },
  };
}

function overview(study) {
  const rows = study.rows.map(({ label, metrics, to_best, ms_per_scan, front, rank }) => [
    label, meanText(metrics.iou), to_best ? meanText(to_best) : '', meanText(metrics.precision), meanText(metrics.recall), fixed(ms_per_scan, 1), front ? '*' : '', fixed(rank, 2),
  ]);
  return table(['method', 'IoU', 'to the best', 'precision', 'recall', 'ms per scan', 'front', 'mean rank'], rows);
}

function effects(study) {
  return (study.effects ?? []).map(({ label, points, settings }) => {
    const rows = [...settings].sort((a, b) => b.total_effect - a.total_effect).map(({ name, total_effect, low, high }) => [
      name, fixed(total_effect, 2), total_effect === null ? '' : `${fixed(low, 2)} to ${fixed(high, 2)}`,
    ]);
    const note = `The part of the IoU's variance that is left while all other sampled settings are fixed, over ${points} points.`;
    return block(`Total effect of each setting on ${label}`, note, table(['setting', 'total effect', '95 %'], rows));
  });
}

/** Of a part of the sequences, "-" where cells of it are missing. */
const partText = (metrics) => (metrics ? meanText(metrics.iou) : '-');

/** The settings that were chosen from a grid, and the unchanged preset, where it was tuned and where it is judged. */
export function choiceRows(choices) {
  return choices.flatMap(({ label, preset, why_none, chosen, base }) => {
    const words = Object.entries(preset?.settings ?? {}).map(([name, value]) => `${name}=${value}`).join(', ');
    return [
      [label, preset ? words : `none: ${why_none}`, partText(chosen.tuned), partText(chosen.judged)],
      ['', 'the preset', partText(base.tuned), partText(base.judged)],
    ];
  });
}

function choiceTable(study) {
  if (!study.choices?.length) return [];
  const files = study.choices.filter(({ preset_file }) => preset_file).map(({ preset_file }) => preset_file).join(', ');
  return [block('Best of the grid', `Chosen where it is tuned alone. ${files}`,
    table(['method', 'settings', 'tuned IoU', 'judged IoU'], choiceRows(study.choices), { leftColumns: 2 }))];
}

/** Cells by why they lack something: a bad scan fails every cell of its sequence. */
function byReason(gaps) {
  const cells = new Map();
  for (const { cell, why } of gaps) cells.set(why, [...(cells.get(why) ?? []), cell]);
  return cells;
}

/** "a 08, near and 3 more cells: why". */
export function gapLines(gaps) {
  return [...byReason(gaps)].map(([why, [first, ...more]]) => `${first}${more.length > 0 ? ` and ${more.length} more ${more.length === 1 ? 'cell' : 'cells'}` : ''}: ${why}`);
}

/** What is bad, and what one should know. */
function remarks(study) {
  const bad = [];
  const lines = ['Metrics are those of all sequences, as the protocol aggregates them; of several seeds their mean. Numbers behind them, and bars, are 95 % intervals: over scans, or of the spread of at least three seeds.'];
  if (study.protocol) lines.unshift(`Scored by ${rulesText(study)}.`);
  if (study.simulated) bad.push('Simulated data: not comparable with published numbers.');
  bad.push(...study.doubts);
  if (study.critical_difference !== null) {
    lines.push(`Mean ranks over ${study.ranked_sequences} sequences differ at 5 % where they are more than ${study.critical_difference.toFixed(2)} apart (Nemenyi).`);
  }
  if (study.cpu_s !== null && study.predicted_cpu_s) {
    lines.push(`The ${study.done} cells that are done took ${(study.cpu_s / study.predicted_cpu_s).toFixed(2)} times the time that was expected.`);
  }
  if (study.done < study.cells) bad.push(`${study.cells - study.done} of ${study.cells} cells are missing.`, ...gapLines(study.missing ?? []));
  bad.push(...gapLines(study.undefined), ...gapLines(study.failures).map((line) => `Failed: ${line}`));
  return [...bad.map((line) => element('p', { class: 'notice' }, line)), ...lines.map((line) => element('p', { class: 'notice quiet' }, line))];
}

/** The worst scans link to the command that shows them in a report. */
function worstScans(study) {
  const commands = new Map();
  for (const { command, cell } of study.worst) if (!commands.has(command)) commands.set(command, { cell, id: `show-${commands.size}` });
  const rows = study.worst.map(({ label, cell, stem, iou, command }) => [
    label, element('a', { href: `#${commands.get(command).id}` }, cell), stem, percent(iou),
  ]);
  const shown = [...commands].map(([command, { cell, id }]) => element('div', { class: 'block', id }, element('p', {}, cell), element('pre', {}, command)));
  return [block('Worst scans', 'Of longer sequences without the first ten scans, whose maps are still empty.', table(['method', 'cell', 'scan', 'IoU'], rows, { leftColumns: 3 })), ...shown];
}

function draw(study) {
  document.title = `mosbench study ${study.name}`;
  const state = new State({ theme: preferredTheme(), scan: 0 });
  const pareto = paretoChart(study.rows);
  const specs = [pareto, ...study.curves.flatMap((curve) => Object.keys(METRICS).map((metric) => curveChart(curve, metric)))];
  const charts = specs.filter((spec) => spec !== null).map((spec) => new Chart(state, spec));
  document.documentElement.dataset.theme = state.get('theme');
  document.body.append(element('main', {},
    element('h1', {}, `Study ${study.name}`), ...remarks(study), element('div', { class: 'block' }, overview(study)),
    element('div', { class: 'charts' }, ...charts.map((chart) => chart.node)), ...choiceTable(study), ...effects(study), ...worstScans(study)));
}

if (globalThis.document?.getElementById('report')) draw(readContent());
