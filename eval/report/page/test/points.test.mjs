import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Clouds } from '../src/clouds.js';
import { allColourings, colourScans, colouringsOf, countOutcomes, limits, quantity, reasonNames, sizePoints } from '../src/colouring.js';
import { countDisputed, opinionNames, opinionsOf } from '../src/disagreement.js';
import { join, movingPoints, StillPoints, toMap } from '../src/motion_map.js';
import { paneAt, paneGrid } from '../src/pane_grid.js';
import { pick } from '../src/picking.js';
import { State } from '../src/state.js';
import { rgb } from '../src/theme.js';
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

test('velocities have a scale, and what is not known a colour of its own', () => {
  const scan = { ...SCAN, velocities_m_s: Float32Array.from([-2, NaN, 3, 50]) };
  const { colours, scale } = colourScans('velocity', [scan], 'light');
  assert.deepEqual(scale, { low: -2, high: 3 });
  assert.deepEqual([...colours[0].slice(3, 6)], [0xcf, 0xd5, 0xdc]);
  assert.notDeepEqual([...colours[0].slice(0, 3)], [...colours[0].slice(6, 9)]);
  assert.equal(join([movingPoints({ ...scan, outcomes: Uint8Array.from([0, 3, 3, 4]) }, [0, 0, 0])]).velocities_m_s[0], -2);
});

test('a scale spans the drawn points, and a flat one still has two ends', () => {
  assert.deepEqual(limits(Float32Array.from([5, 1, 3])), [1, 5]);
  assert.deepEqual(limits(Float32Array.from([2, 2])), [2, 3]);
  assert.deepEqual(limits(Float32Array.from([])), [0, 1]);
  assert.deepEqual(colourScans('height', [SCAN], 'light').scale, { low: -1, high: 2 });
  assert.deepEqual([colourScans('range', [], 'light').scale, colourScans('range', [], 'light').colours], [null, []]);
});

test('two scans share one scale, from one vote to the most that is drawn', () => {
  const scored = (scores) => ({ ...SCAN, scores: Int32Array.from(scores) });
  const { colours, scale } = colourScans('score', [scored([0, 4, 8, 999]), scored([0, 16, 0, 0])], 'light');
  assert.deepEqual(scale, { low: 1, high: 17, digits: 0 });
  const at = (s, i) => [...colours[s].slice(3 * i, 3 * i + 3)];
  assert.deepEqual(at(0, 0), [0xcf, 0xd5, 0xdc], 'no vote has a colour of its own');
  assert.deepEqual(at(0, 0), at(1, 0));
  assert.notDeepEqual(at(0, 1), at(0, 2));
  assert.deepEqual(at(0, 3), [0xfe, 0xe8, 0x38], 'beyond the scale is its end');
});

test('a scale of scores that are no votes spans those that are not 0', () => {
  const { colours, scale } = colourScans('score', [{ ...SCAN, scores: [-0.5, 0, 0.5, 9] }], 'light');
  assert.deepEqual(scale, { low: -0.5, high: 0.5, digits: 2 });
  assert.deepEqual([...colours[0].slice(3, 6)], [0xcf, 0xd5, 0xdc], '0 has a colour of its own');
});

test('scores are offered only where every shown run kept them, and of one kind', () => {
  const of = (name) => ({ method: { name } });
  const clouds = new Clouds({ clouds: [], results: [
    { scores: [3], score_name: 'margin', result: of('A') }, { scores: [] }, {}, { scores: [4], result: of('B') },
    { scores: [3], score_name: 'margin', result: of('B') }, { scores: [3], score_name: 'margin', result: of('A') }] });
  const score = (...results) => allColourings(clouds, results, 'orbit').find(({ key }) => key === 'score');
  assert.deepEqual([score(0).why, score(0, 1).why, score(0, 3).why], [null, 'needs mosbench run --write scores', 'not of different methods']);
  assert.deepEqual([score(0, 4).why, score(0, 5).why], ['not of different methods', null]);
  assert.deepEqual([score(0).name, score(3).name], ['margin', 'score']);
  assert.equal(colouringsOf(clouds, [1], 'orbit').some(({ key }) => key === 'score'), false);
});

test('reasons are coloured as the palette says, and offered only where a shown run gives some', () => {
  const clouds = new Clouds({ clouds: [], results: [{ reasons: [3] }, { reasons: [] }, {}] });
  const why = (...results) => allColourings(clouds, results, 'orbit').find(({ key }) => key === 'reason')?.why;
  assert.deepEqual([why(0), why(0, 1), why(1), why(2)], [null, 'not given by every run', undefined, undefined]);
  const { colours, scale } = colourScans('reason', [{ ...SCAN, reasons: Uint8Array.from([1, 0, 2, 4]) }], 'light');
  assert.equal(scale, null);
  const names = reasonNames('light');
  assert.deepEqual(names.map(({ name }) => name), ['not called moving', 'arrived in free space', 'left free space behind', 'connected with such', 'feet', 'where an object is expected']);
  assert.deepEqual([1, 0, 2, 4].map((reason) => rgb(names[reason].colour)), [0, 1, 2, 3].map((i) => [...colours[0].slice(3 * i, 3 * i + 3)]));
});

test('disagreement is offered beside a run, outside of the motion map', () => {
  const clouds = new Clouds({ clouds: [{ scans: [] }], results: [{ cloud: 0 }, { cloud: 0 }, {}] });
  const why = (results, view) => allColourings(clouds, results, view).find(({ key }) => key === 'disagreement')?.why;
  assert.deepEqual([why([0, 1], 'orbit'), why([0, 1], 'map'), why([0], 'orbit'), why([2], 'orbit')], [null, 'not in the motion map', 'needs a run beside', undefined]);
});

test('disagreement says who calls a point moving: the first run against each other, and against all', () => {
  const says = (...outcomes) => ({ ...SCAN, outcomes: Uint8Array.from(outcomes) });
  // tp fp fn tn: by the truth; 4 and 5: not judged, called static and moving
  const scans = [says(0, 1, 2, 4), says(0, 3, 0, 4), says(2, 1, 2, 5)];
  assert.deepEqual(scans.map((_, p) => [...opinionsOf(scans, p)]), [[1, 1, 2, 2], [0, 1, 2, 3], [1, 0, 3, 2]]);
  assert.deepEqual(countDisputed(opinionsOf(scans, 0)), { first: 2, other: 2 });
  const { colours, scale, large } = colourScans('disagreement', scans, 'light');
  assert.equal(scale, null);
  assert.deepEqual([large(1, 0), large(1, 1), large(1, 2), large(1, 3)], [false, true, true, false]);
  const keys = opinionNames(['a', 'b'], 'light');
  assert.deepEqual(keys.map(({ name }) => name), ['moving in both', 'moving in a alone', 'moving in b alone', 'static in both']);
  assert.deepEqual([...colours[1].slice(3, 6)], rgb(keys[1].colour));
  assert.equal(opinionNames(['a', 'b', 'c'], 'light')[2].name, 'moving in the other alone');
});

test('panes fill a grid that suits the screen', () => {
  const shape = (panes, width) => {
    const { columns, rows } = paneGrid(panes, { width, height: 400 });
    return `${columns}x${rows}`;
  };
  assert.deepEqual([0, 1, 2, 3, 4, 5, 6].map((n) => shape(n, 1200)), ['1x1', '1x1', '2x1', '3x1', '2x2', '3x2', '3x2']);
  assert.deepEqual([1, 2, 3, 4, 5, 6].map((n) => shape(n, 380)), ['1x1', '1x2', '2x2', '2x2', '2x3', '2x3']);
  const grid = paneGrid(5, { width: 1200, height: 400 });
  assert.deepEqual(paneAt(grid, 5, 450, 250), { pane: 4, x: 50, y: 50 });
  assert.equal(paneAt(grid, 5, 900, 250), null, 'the sixth pane is empty');
});

test('hidden outcomes and points without a place have no size, judged moving ones are larger', () => {
  const { large } = colourScans('outcome', [SCAN], 'light');
  const sizes = (visible) => [...sizePoints(SCAN, visible, 1, (i) => large(0, i))].map((s) => Math.round(10 * s));
  assert.deepEqual(sizes(ALL), [18, 10, 18, 0]);
  assert.equal(sizes(ALL.with(0, false))[0], 0);
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

test('the motion map holds what stands still once per cell', () => {
  const still = new StillPoints();
  for (let scan = 0; scan < 2; ++scan) still.add(SCAN, [10, 20, 30]);
  assert.deepEqual([...still.positions_m()], [0, 0, 2], 'neither moving points nor those without a place');
});

test('a run that was not scored in a scan disagrees with none', () => {
  const scans = [SCAN, { ...SCAN, outcomes: Uint8Array.from([4, 4, 4, 4]), unscored: true }];
  assert.deepEqual(scans.map((_, p) => [...opinionsOf(scans, p)]), [[3, 3, 3, 3], [3, 3, 3, 3]]);
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
