import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Clouds } from '../src/clouds.js';
import { colourScans, colouringsOf, countOutcomes, limits, quantity, sizePoints } from '../src/colouring.js';
import { join, movingPoints, toMap } from '../src/motion_map.js';
import { pick } from '../src/picking.js';
import { State } from '../src/state.js';
import { extent, viewpoint } from '../src/views.js';

const SCAN = {
  points: 4,
  positions_m: Float32Array.from([3, 4, 0, 0, 0, 2, 1, 0, -1, 0, 0, 0]),
  outcomes: Uint8Array.from([0, 3, 2, 4]),
  drawable: Uint8Array.from([1, 1, 1, 0]),
  pose: [0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30],
};
const ALL = [true, true, true, true, true, true];

test('points are coloured by outcome as the palette says', () => {
  const { colours, scale } = colourScans('outcome', [SCAN], 'light');
  assert.deepEqual([...colours[0].slice(0, 3)], [0x00, 0x72, 0xb2]);
  assert.equal(scale, null);
  assert.deepEqual(countOutcomes(SCAN.outcomes), [1, 0, 1, 1, 1, 0]);
});

test('range and height are those of the positions', () => {
  assert.deepEqual([...quantity('range', SCAN)].map((r) => Math.round(1000 * r)), [5000, 2000, 1414, 0]);
  assert.deepEqual([...quantity('height', SCAN)], [0, 2, -1, 0]);
});

test('a scale spans the drawn points, and a flat one still has two ends', () => {
  assert.deepEqual(limits(Float32Array.from([5, 1, 3])), [1, 5]);
  assert.deepEqual(limits(Float32Array.from([2, 2])), [2, 3]);
  assert.deepEqual(limits(Float32Array.from([])), [0, 1]);
  assert.deepEqual(colourScans('height', [SCAN], 'light').scale, { low: -1, high: 2 });
});

test('two scans share one scale, from one vote to the most that is drawn', () => {
  const scored = (scores) => ({ ...SCAN, scores: Int32Array.from(scores) });
  const { colours, scale } = colourScans('score', [scored([0, 4, 8, 999]), scored([0, 16, 0, 0])], 'light');
  assert.deepEqual(scale, { low: 1, high: 17 });
  const at = (s, i) => [...colours[s].slice(3 * i, 3 * i + 3)];
  assert.deepEqual(at(0, 0), [0xcf, 0xd5, 0xdc], 'no vote has a colour of its own');
  assert.deepEqual(at(0, 0), at(1, 0));
  assert.notDeepEqual(at(0, 1), at(0, 2));
  assert.deepEqual(at(0, 3), [0xfe, 0xe8, 0x38], 'beyond the scale is its end');
});

test('scores are offered only where every shown run kept them', () => {
  const clouds = new Clouds({ clouds: [], results: [{ scores: [3] }, { scores: [] }, {}] });
  const offers = (...results) => colouringsOf(clouds, results).some(({ key }) => key === 'score');
  assert.deepEqual([offers(0), offers(1), offers(2), offers(0, 1)], [true, false, false, false]);
});

test('hidden outcomes and points without a place have no size, judged moving ones are larger', () => {
  assert.deepEqual([...sizePoints(SCAN, ALL, 1)].map((s) => Math.round(10 * s)), [18, 10, 18, 0]);
  assert.equal(sizePoints(SCAN, ALL.with(0, false), 1)[0], 0);
});

test('the motion map holds moving points in the frame of the map', () => {
  assert.deepEqual(toMap(SCAN.pose, 3, 4, 0, [0, 0, 0]), [6, 23, 30]);
  const part = movingPoints(SCAN, [10, 20, 30]);
  assert.deepEqual([...part.outcomes], [0, 2]);
  assert.deepEqual([...part.positions_m], [-4, 3, 0, 0, 1, -1]);
  const map = join([part, part]);
  assert.equal(map.points, 4);
  assert.deepEqual([...map.positions_m.slice(6, 9)], [-4, 3, 0]);
  assert.deepEqual(map.path, [[0, 0, 0], [0, 0, 0]]);
  assert.equal(map.scores, null);
  const scored = movingPoints({ ...SCAN, scores: [5, 6, 7, 8] }, [10, 20, 30]);
  assert.deepEqual([...join([scored, scored]).scores], [5, 7, 5, 7]);
  assert.equal(join([scored, part]).scores, null);
});

test('the nearest point to the eye under the pointer is picked, never a hidden one', () => {
  const identityWithDepth = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1]; // w = z + 1
  const positions = Float32Array.from([0, 0, 3, 0, 0, 1, 0, 0, 0.5, 5, 5, 0]);
  const at = { x: 50, y: 50, width: 100, height: 100 };
  assert.equal(pick(positions, [1, 1, 0, 1], identityWithDepth, at), 1);
  assert.equal(pick(positions, [1, 1, 1, 1], identityWithDepth, { ...at, x: 5, y: 95 }), -1);
});

test('a viewpoint exists for a map without points', () => {
  const { eye } = viewpoint('map', { path: [], positions_m: new Float32Array() });
  assert.ok(eye.every(Number.isFinite));
  const wide = { positions_m: Float32Array.from([30, 4, 0]), path: [[0, 0, 0], [-10, 0, 0]] };
  assert.deepEqual(extent(wide), { middle: [10, 2], reach_m: 20 });
});

test('followers hear of changes of what they follow, and only of those', () => {
  const state = new State({ a: 1, b: 1 });
  const heard = [];
  state.follow(['a'], () => heard.push(state.get('a')));
  state.set({ b: 2 });
  state.set({ a: 1 });
  state.set({ a: 2, b: 3 });
  assert.deepEqual(heard, [1, 2]);
});

test('clouds know which scans and runs belong together', async () => {
  const clouds = new Clouds({
    clouds: [{ left_out: '', scans: [{ index: 2 }, { index: 9 }] }, { left_out: 'most', scans: [] }],
    results: [{ cloud: 0 }, { cloud: 1 }, { cloud: 0 }, {}],
  });
  assert.deepEqual(clouds.scansOf(0), [2, 9]);
  assert.deepEqual(clouds.scansOf(3), []);
  assert.deepEqual([clouds.comparable(0), clouds.comparable(1), clouds.comparable(3)], [[2], [], []]);
  assert.deepEqual([clouds.nearest(0, 5), clouds.nearest(0, 6), clouds.nearest(1, 3)], [2, 9, null]);
  assert.equal(clouds.leftOut(1), 'most');
  assert.equal(await clouds.read(0, 5), null);
});
