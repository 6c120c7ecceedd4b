import assert from 'node:assert/strict';
import { test } from 'node:test';
import { count, fixed, intervalOf, percent } from '../src/format.js';
import { iou, precision, recall, worstScans } from '../src/metrics.js';
import { flatten } from '../src/provenance.js';
import { costColumns, metricsChart, stagesChart } from '../src/scan_charts.js';

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
