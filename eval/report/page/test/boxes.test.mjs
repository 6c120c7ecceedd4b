import assert from 'node:assert/strict';
import { test } from 'node:test';
import { corners, edges, placeIn, raised, speedText, topOf } from '../src/boxes.js';

const BOX = [10, 5, 1, Math.PI / 2, 4, 2, 1.5, 3.04];

test('a box that faces left is long to the left', () => {
  const at = corners(BOX);
  const span = (axis) => Math.max(...at.map((p) => p[axis])) - Math.min(...at.map((p) => p[axis]));
  assert.ok(Math.abs(span(0) - 2) < 1e-9);
  assert.ok(Math.abs(span(1) - 4) < 1e-9);
  assert.ok(Math.abs(span(2) - 1.5) < 1e-9);
  assert.ok(at.slice(0, 4).every(([, , z]) => z === 0.25));
});

test('twelve edges join corners that differ along one side', () => {
  const ends = edges([[0, 0, 0, 0, 4, 2, 1, null]]);
  assert.equal(ends.length, 24);
  for (let i = 0; i < ends.length; i += 2) {
    assert.equal(ends[i].filter((value, axis) => value !== ends[i + 1][axis]).length, 1);
  }
});

test('speeds are written over the middle of the top, none for what was seen once', () => {
  assert.equal(speedText(BOX), '3.0 m/s');
  assert.equal(speedText([...BOX.slice(0, 7), null]), '');
  assert.deepEqual(topOf(BOX), [10, 5, 1.75]);
});

test('a place is in pixels of the pane, none outside of it or behind the eye', () => {
  const same = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  assert.deepEqual(placeIn([0.5, -0.5, 0], same, { width: 200, height: 100 }), { x: 150, y: 75 });
  assert.equal(placeIn([1.5, 0, 0], same, { width: 200, height: 100 }), null);
  const behind = [...same.slice(0, 15), -1];
  assert.equal(placeIn([0, 0, 0], behind, { width: 200, height: 100 }), null);
});

test('texts that would cover one another are moved up', () => {
  const [taken, size] = [[], { width: 40, height: 10 }];
  assert.deepEqual(raised({ x: 50, y: 100 }, taken, size), { x: 50, y: 100 });
  assert.deepEqual(raised({ x: 60, y: 104 }, taken, size), { x: 60, y: 90 });
  assert.deepEqual(raised({ x: 20, y: 85 }, taken, size), { x: 20, y: 85 });
  assert.deepEqual(raised({ x: 50, y: 100 }, taken, size), { x: 50, y: 75 });
});
