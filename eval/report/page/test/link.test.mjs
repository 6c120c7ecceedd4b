import assert from 'node:assert/strict';
import { test } from 'node:test';
import { hashOf, viewOf } from '../src/link.js';
import { State } from '../src/state.js';

const scans = new Array(30).fill({});
const CONTENT = { results: [{ result: { scans } }, { result: { scans } }, { result: { scans: [] } }] };
const comparable = (result) => [1, 0].filter((other) => other !== result);
const read = (hash) => viewOf(hash, CONTENT, comparable);

test('a link leads to the view that it was made of', () => {
  const view = { result: 0, others: [1], scan: 21, view: 'sensor', colouring: 'height' };
  const hash = hashOf(new State(view), { eye: [-22.004, 1, 17], target: [4, 0, -1] });
  assert.equal(hash, '#result=0&beside=1&scan=21&view=sensor&colour=height&eye=-22,1,17&target=4,0,-1');
  assert.deepEqual(read(hash), { changes: view, camera: { eye: [-22, 1, 17], target: [4, 0, -1] } });
});

test('a link says whether boxes are shown', () => {
  const hash = hashOf(new State({ result: 1, others: [], scan: 2, view: 'top', colouring: 'height', boxes: true }), { eye: [0, 0, 9], target: [0, 0, 0] });
  assert.match(hash, /&boxes=1&/);
  assert.equal(read(hash).changes.boxes, true);
  assert.ok(!('boxes' in read('#result=1&boxes=yes').changes));
});

test('what is not of the report is left out of a link', () => {
  assert.deepEqual(read(''), { changes: {}, camera: null });
  assert.deepEqual(read('#result=3&scan=1'), { changes: {}, camera: null });
  assert.deepEqual(read('#result=1&beside=1,2,9&scan=30&view=<b>&colour=x&eye=1,2&target=0,0,0').changes, { result: 1, others: [] });
  assert.equal(read('#result=0&eye=1,2,NaN&target=0,0,0').camera, null);
  assert.equal(read('#result=0&eye=1,2,1e9&target=0,0,0').camera, null);
});
