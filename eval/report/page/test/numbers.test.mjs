import assert from 'node:assert/strict';
import { test } from 'node:test';
import { comparisonCharts } from '../src/comparison_charts.js';
import { count, fixed, intervalOf, percent, whyNoInterval } from '../src/format.js';
import { iou, precision, recall, typicalScan, worstScans } from '../src/metrics.js';
import { flatten } from '../src/provenance.js';
import { runNames, runOptions, toggled } from '../src/runs_menu.js';
import { resultsOfSameScans } from '../src/same_scans.js';
import { costColumns, metricsChart, stagesChart, thresholdChart } from '../src/scan_charts.js';
import { precisionAt, scoreCurveChart } from '../src/score_curve.js';
import { RUN_LINES, runLine } from '../src/theme.js';

test('a typical scan is the median of those in which something moves and is looked for', () => {
  const scan = (stem, tp, fn) => ({ stem, tp, fp: 0, fn, tn: 9 });
  const result = { scans: [scan('idle', 0, 9), scan('still', 0, 0), scan('all', 9, 0), scan('half', 5, 5), scan('few', 1, 9), { stem: 'no truth' }], scans_without_detection: ['idle'] };
  assert.equal(typicalScan(result, [0, 1, 2, 3, 4, 5]), 3);
  assert.equal(typicalScan(result, [0, 1, 4, 5]), 4);
  assert.equal(typicalScan(result, [0, 1, 5]), null);
});

test('without truth a typical scan is the median by the points labelled moving', () => {
  const scans = [9, 0, 40, 7, 20].map((moving, k) => ({ stem: `${k}`, predicted_moving_points: moving }));
  assert.equal(typicalScan({ scans, scans_without_detection: ['4'] }, [0, 1, 2, 3, 4]), 0);
  assert.equal(typicalScan({ scans }, [1]), null);
});

test('metrics of a scan worked by hand', () => {
  const counts = { tp: 6, fp: 2, fn: 4, tn: 100 };
  assert.deepEqual([iou(counts), precision(counts), recall(counts)], [0.5, 0.75, 0.6]);
});

test('metrics without any point to judge are nothing', () => {
  const counts = { tp: 0, fp: 0, fn: 0, tn: 5 };
  assert.deepEqual([iou(counts), precision(counts), recall(counts)], [null, null, null]);
});

test('worst scans come by their false points, idle ones last, right ones and unlabelled ones never', () => {
  const scan = (stem, fp, fn) => ({ stem, tp: 1, fp, fn, tn: 1 });
  const scans = [scan('a', 90, 9), scan('b', 0, 3), { stem: 'c' }, scan('d', 5, 0), scan('e', 0, 0), scan('f', 1, 2)];
  assert.deepEqual(worstScans({ scans, scans_without_detection: ['a'] }), [3, 1, 5, 0]);
});

test('numbers read well, and nothing is not zero', () => {
  assert.deepEqual([percent(0.12345), percent(null), count(1234567), count(null), fixed(1.26, 1, 'ms'), fixed(undefined, 1)], ['12.3 %', 'undefined', '1,234,567', '–', '1.3 ms', '–']);
});

test('an estimate without interval has none', () => {
  assert.deepEqual([intervalOf({ value: 1, low: null, high: null }), intervalOf(null), intervalOf({ low: 0, high: 1 })], [null, null, [0, 1]]);
});

test('a missing interval says why, in numbers and below the chart', () => {
  const iouOf = { value: 0.5, low: null, high: null, no_interval: '12 scans, expected at least 100' };
  assert.equal(whyNoInterval(iouOf), 'no interval: 12 scans, expected at least 100');
  assert.deepEqual([whyNoInterval({ low: 0, high: 1, no_interval: null }), whyNoInterval(undefined)], [null, null]);
  const result = { scans: [{ tp: 1, fp: 1, fn: 0 }], summary: { iou: 0.5 } };
  assert.equal(metricsChart({ result, estimates: { iou: iouOf } }).note, 'the dashed line is the whole; no interval: 12 scans, expected at least 100');
  assert.equal(metricsChart({ result, estimates: null }).note, 'the dashed line is the whole');
});

test('provenance names nested values by their path', () => {
  assert.deepEqual(flatten({ a: { b: 1, c: { d: 'x' } }, e: null, f: [1, 2] }), [['a.b', '1'], ['a.c.d', 'x'], ['e', 'null'], ['f', '[1,2]']]);
});

const TIMED = {
  scans: [{ tp: 1, fp: 1, fn: 0 }, {}],
  summary: { iou: 0.5 },
  timing: { scan_columns: ['read_ms', 'push_ms', 'resident_mib', 'voxelize_ms', 'map_update_ms'], scans: [[1, 9, 50, 2, 3], [1, 8, 51, 4, 5]] },
};

test('costs are columns by name', () => {
  assert.deepEqual(costColumns(TIMED).map_update_ms, [3, 5]);
  assert.equal(costColumns({}), null);
});

test('stages stack up to their sum while their own numbers stay', () => {
  const [top, bottom] = stagesChart({ result: TIMED }).series;
  assert.deepEqual([top.label, top.values, top.drawn], ['map update', [3, 5], [5, 9]]);
  assert.deepEqual([bottom.label, bottom.drawn], ['voxelize', [2, 4]]);
});

test('the chart of metrics has gaps where there is no truth, and a band where there is an interval', () => {
  const plain = metricsChart({ result: TIMED });
  assert.deepEqual(plain.series[0].values, [0.5, null]);
  assert.deepEqual(plain.options.bands, []);
  const banded = metricsChart({ result: TIMED, estimates: { iou: { value: 0.5, low: 0.4, high: 0.6 } } });
  assert.deepEqual(banded.series.slice(4).map(({ values }) => values[0]), [0.4, 0.6]);
  assert.equal(metricsChart({ result: { ...TIMED, summary: null } }), null);
});

test('charts of two runs hold both, and only what both have', () => {
  const otsu = { threshold_name: 'Otsu threshold', score_name: 'dynamic score' };
  const first = { run: 'online', ...otsu, result: TIMED };
  const second = { run: 'delayed', ...otsu, result: { ...TIMED, scans: [{ tp: 3, fp: 0, fn: 1, threshold: 7 }, { threshold: 8 }] } };
  const both = Object.fromEntries(comparisonCharts([first, second]).map((chart) => [chart.key, chart]));
  assert.deepEqual(both.iou.series.map(({ label, values }) => [label, values]), [['online', [0.5, null]], ['delayed', [0.75, null]]]);
  assert.deepEqual(both.time.series.map(({ values }) => values), [[9, 8], [9, 8]]);
  assert.deepEqual(both.threshold.series.map(({ values }) => values), [[null, null], [7, 8]]);
  assert.notEqual(both.fp.series[0].colour.light, both.fp.series[1].colour.light);
  assert.notDeepEqual(both.fp.series[0].dash, both.fp.series[1].dash);
  const untimed = { ...second, result: { ...second.result, timing: undefined } };
  assert.deepEqual(comparisonCharts([first, untimed]).map(({ key }) => key), ['iou', 'precision', 'recall', 'fp', 'fn', 'threshold']);
});

test('runs of one name are numbered', () => {
  assert.deepEqual(runNames([{ run: 'a' }, { run: 'a' }]), ['a (1)', 'a (2)']);
  assert.deepEqual(runNames([{ run: 'a' }, { run: 'b' }]), ['a', 'b']);
  assert.deepEqual(runNames([{ run: 'a' }, { run: 'b' }, { run: 'a' }]), ['a (1)', 'b', 'a (2)']);
  assert.deepEqual(runOptions({ results: [{ run: 'a' }, { run: 'b' }, { run: 'a' }] }, 0, [1, 2]), [{ key: 1, name: 'b' }, { key: 2, name: 'a (2)' }]);
  assert.deepEqual([toggled([1, 2], 3), toggled([1, 2], 1)], [[1, 2, 3], [2]]);
});

test('a threshold is shown by its name in the method, where it has one that varies', () => {
  const scans = [{ threshold: 3 }, { threshold: null }, { threshold: 4 }];
  const entry = (threshold_name, thresholds = scans) => ({ run: 'a', threshold_name, score_name: 'margin, m', result: { scans: thresholds, summary: null } });
  const { title, note, series } = thresholdChart(entry('range tolerance, m'));
  assert.deepEqual([title, note, series[0].values], ['Range tolerance, m', 'of the margin, m; none where no motion was looked for', [3, null, 4]]);
  assert.equal(thresholdChart(entry('')), null);
  assert.equal(thresholdChart(entry(undefined)), null);
  assert.equal(thresholdChart(entry('a', [{ threshold: 3 }, {}, { threshold: 3 }])), null, 'a setting');
  const keys = (...names) => comparisonCharts(names.map((name) => entry(name))).map(({ key }) => key);
  assert.deepEqual([keys('a', 'a', 'a'), keys('a', 'b')], [['threshold'], []], 'different thresholds have no common axis');
});

test('curves of several runs share one axis, each with its own points, and dots of their labels', () => {
  const curve = (run, results, recalls, precisions) => ({ run, results, recall: recalls, precision: precisions, average_precision: 0.5, labels: { recall: 0.4, precision: 0.9 } });
  const curves = [curve('a', [0], [0.2, 0.2, 1], [1, 0.9, 0.3]), curve('b', [1], [0.5, 1], [0.8, 0.2]), curve('c', [2], [1], [0.1])];
  const { x, series, options } = scoreCurveChart(curves, [0, 1]);
  assert.deepEqual(x, [0.2, 0.2, 0.5, 1, 1]);
  assert.deepEqual(series.map(({ drawn }) => drawn), [[1, 0.9, null, 0.3, null], [null, null, 0.8, null, 0.2]]);
  assert.deepEqual(series.map(({ label, values }) => [label, values]), [['a, AP 50.0 %', [1, 1, 0.3, 0.3, 0.3]], ['b, AP 50.0 %', [0.8, 0.8, 0.8, 0.2, 0.2]]]);
  assert.deepEqual(options.marks.map((mark) => [mark.x, mark.y]), [[0.4, 0.9], [0.4, 0.9]]);
  assert.deepEqual(precisionAt({ recall: [0.5], precision: [0.7] }, [0.1, 0.6]), [0.7, null]);
  assert.deepEqual([scoreCurveChart(curves, [3]), scoreCurveChart(undefined, [0])], [null, null]);
});

test('curves are drawn as their runs are in other charts, and not under other rules', () => {
  const curve = (run, results) => ({ run, results, recall: [1], precision: [0.5], average_precision: 0.5, labels: { recall: 1, precision: 0.5 } });
  const { series } = scoreCurveChart([curve('a', [0]), curve('b', [1]), curve('c', [2])], [2, null, 0]);
  assert.deepEqual(series.map(({ label }) => label[0]), ['c', 'a']);
  assert.deepEqual(series.map(({ colour }) => colour), [runLine(0).colour, runLine(2).colour]);
  assert.equal(series[0].points.show, true); // one point makes no line
  const many = Array.from({ length: 12 }, (_, i) => i);
  assert.equal(scoreCurveChart(many.map((i) => curve(`r${i}`, [i])), many).series.length, RUN_LINES.length);
});

test('results are of the same scans when sequence and stems are', () => {
  const entry = (sequence, ...stems) => ({ result: { sequence, scans: stems.map((stem) => ({ stem })) } });
  const content = { results: [entry('00', '1', '2'), entry('00', '1', '2'), entry('00', '1', '3'), entry('01', '1', '2'), entry('00', '1')] };
  assert.deepEqual(content.results.map((_, i) => resultsOfSameScans(content, i)), [[1], [0], [], [], []]);
});
