import assert from 'node:assert/strict';
import { test } from 'node:test';
import { driftChart } from '../src/path_charts.js';
import { frameOf, gridStep_m, pathsOf } from '../src/path_view.js';

const OWN = { run: 'own', path: { run_m: [[0, 0], [40, 0], [80, 20]] } };
const FOUND = { run: 'found', path: { run_m: [[0, 0], [40, 1], [80, 22]], own_m: OWN.path.run_m, way_m: [0, 40, 84.721], off_m: [0, 1, 2] } };

test('the path of the data set stands beside that of a run with other poses, and only then', () => {
  assert.deepEqual(pathsOf([OWN], ['own']).map(({ label }) => label), ['own']);
  assert.deepEqual(pathsOf([FOUND], ['found']).map(({ label }) => label), ['poses of the data set', 'found']);
  assert.deepEqual(pathsOf([OWN, FOUND], ['a', 'b']).map(({ label, key }) => [label, key]), [['poses of the data set', null], ['a', 0], ['b', 1]]);
  assert.deepEqual(pathsOf([{ run: 'numbers only' }], ['numbers only']), []);
});

test('metres are as long along both axes, and everything is inside', () => {
  const { low, size } = frameOf(pathsOf([FOUND], ['found']));
  assert.equal(size[0] / size[1], 500 / 210);
  assert.ok(low[0] < 0 && low[0] + size[0] > 80 && low[1] < 0 && low[1] + size[1] > 22);
  assert.equal(gridStep_m({ low, size }), 20);
});

test('a sensor that stands still has a frame, too', () => {
  const { size } = frameOf([{ points_m: [[5, 5], [5, 5]] }]);
  assert.equal(size[1], 1.1);
});

test('errors go over the way of the data set, of the runs with other poses', () => {
  assert.equal(driftChart([OWN], ['own']), null);
  const chart = driftChart([OWN, FOUND], ['a', 'b']);
  assert.deepEqual(chart.x, [0, 40, 84.721]);
  assert.deepEqual(chart.series.map(({ label, values }) => [label, values]), [['b', [0, 1, 2]]]);
});
