import assert from 'node:assert/strict';
import { test } from 'node:test';
import { rulesText } from '../src/format.js';
import { choiceRows, curveChart, gapLines, logTicks, paretoChart } from '../src/study.js';

const point = (value, low = null, high = null) => ({ iou: { value, low, high }, precision: { value: 1 }, recall: { value: null } });
const curve = {
  axis: 'pose_noise_m', unit: 'm', values: ['none', '0.05'],
  lines: [{ label: 'a', points: [point(0.8, 0.7, 0.9), point(0.6)] }, { label: 'b', points: [point(0.5), point(null)] }],
};

test('a curve has a line per method over the strengths, and bars where there are intervals', () => {
  const chart = curveChart(curve, 'iou');
  assert.deepEqual(chart.x, [0, 1]);
  assert.deepEqual(chart.series.map(({ label, values }) => [label, values]), [['a', [0.8, 0.6]], ['b', [0.5, null]]]);
  assert.deepEqual(chart.options.xAxis.values(null, [0, 1, 2]), ['none', '0.05', '']);
  const bars = chart.options.whiskers.filter(({ low }) => low !== null);
  assert.deepEqual(bars.map(({ x, low, high }) => [x, low, high]), [[-0.025, 0.7, 0.9]]);
  assert.equal(curveChart({ ...curve, unit: '1' }, 'iou').note, '');
});

test('the default of a setting is a dot apart, which no line joins to the values', () => {
  const chart = curveChart({ ...curve, axis: 'voxel_size_m', unit: '', values: ['default', '0.1'] }, 'iou');
  assert.deepEqual(chart.series.map(({ values, drawn }) => [values, drawn]), [[[0.8, 0.6], [null, 0.6]], [[0.5, null], [null, null]]]);
  assert.deepEqual(chart.options.marks.map(({ x, y }) => [x, y]), [[0, 0.8], [0, 0.5]]);
  const disturbed = curveChart(curve, 'iou');
  assert.ok(disturbed.options.marks === undefined && disturbed.series.every(({ drawn }) => drawn === undefined));
});

test('cells that failed alike are told once', () => {
  const failures = [{ cell: 'a', why: 'cut off' }, { cell: 'b', why: 'no pose' }, { cell: 'c', why: 'cut off' }];
  assert.deepEqual(gapLines(failures), ['a and 1 more cell: cut off', 'b: no pose']);
});

test('chosen settings stand above the preset, and a part with missing cells is a dash', () => {
  const rows = choiceRows([
    { label: 'a', preset: { settings: { max_range_m: 20, variant: 'x' } }, chosen: { tuned: point(0.8), judged: null }, base: { tuned: point(0.5), judged: point(0.6) } },
    { label: 'b', preset: null, why_none: '1 cell of tune_on is missing', chosen: { tuned: null, judged: null }, base: { tuned: null, judged: null } },
  ]);
  assert.deepEqual(rows, [
    ['a', 'max_range_m=20, variant=x', '80.0 %', '-'], ['', 'the preset', '50.0 %', '60.0 %'],
    ['b', 'none: 1 cell of tune_on is missing', '-', '-'], ['', 'the preset', '-', '-'],
  ]);
});

test('the rules of a number say which points count', () => {
  const rules = (min_range_m, max_range_m) => rulesText({ protocol: 'p', min_range_m, max_range_m });
  assert.equal(rules(0.5, 20), 'protocol p, 0.5 to 20 m');
  assert.equal(rules(3, -1), 'protocol p, from 3 m');
  assert.equal(rules(0, -1), 'protocol p');
});

test('ticks of a logarithmic axis are round numbers', () => {
  assert.deepEqual(logTicks(11.393111303703705, 78), [20, 50]);
  assert.deepEqual(logTicks(0.05, 1), [0.05, 0.1, 0.2, 0.5, 1]);
});

test('the Pareto plot has a dot per method with IoU and time, and none without', () => {
  const row = (label, value, ms_per_scan, front) => ({ label, front, ms_per_scan, metrics: { iou: { value } } });
  const chart = paretoChart([row('slow', 0.9, 40, true), row('unknown', 0.9, null, false), row('fast', 0.5, 10, true), row('worse', 0.4, 20, false)]);
  assert.deepEqual(chart.x, [10, 20, 40]);
  assert.deepEqual(chart.series.map(({ label, values }) => [label, values]),
    [['slow *', [null, null, 0.9]], ['fast *', [0.5, null, null]], ['worse', [null, 0.4, null]]]);
  assert.equal(paretoChart([row('unknown', null, 1, false)]), null);
});
