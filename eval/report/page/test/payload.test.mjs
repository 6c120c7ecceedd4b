import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { outcomesFromPlane, positionsFromPlanes, readBlock, readContent, scoresFromPlanes } from '../src/payload.js';

/** A document that holds elements with text. */
function documentWith(texts) {
  return { getElementById: (id) => ({ textContent: texts[id] }) };
}

test('positions are summed differences, sign in the lowest bit', () => {
  // The vector of the C++ test PointPlanes.HoldDifferencesOfCentimetresInZigzag.
  const planes = Uint8Array.from([2, 2, 1, 3, 600 & 255, 599 & 255, 0, 0, 0, 0, 2, 2]);
  assert.deepEqual([...positionsFromPlanes(planes, 1)], [1, -1, 300, 2, -3, 0]);
});

test('positions wrap around in 16 bits as they were packed', () => {
  // From 32767 to -32767 is a difference of 2 modulo 65536.
  const code = (steps) => ((steps << 1) ^ (steps >> 15)) & 0xffff;
  const codes = [code(32767), code(2)];
  const planes = Uint8Array.from([...codes.map((c) => c & 255), 0, 0, 0, 0, ...codes.map((c) => c >> 8), 0, 0, 0, 0]);
  const positions = positionsFromPlanes(planes, 1);
  assert.deepEqual([positions[0], positions[3]], [32767, -32767]);
});

test('scores are put together from their bytes', () => {
  // The vector of the C++ test PointPlanes.HoldScoresByteByByte.
  assert.deepEqual([...scoresFromPlanes(Uint8Array.from([0, 0, 0, 0, 0x40, 0x80, 0x40, 0x3f]))], [3, 1]);
});

test('outcomes keep their number apart from whether they have a place', () => {
  const { outcomes, drawable } = outcomesFromPlane(Uint8Array.from([0, 3, 11, 13]));
  assert.deepEqual([...outcomes], [0, 3, 3, 5]);
  assert.deepEqual([...drawable], [1, 1, 0, 0]);
});

test('a block is unpacked from base64 and zlib', async () => {
  const bytes = Uint8Array.from({ length: 1000 }, (_, i) => (i * 7) & 255);
  const root = documentWith({ 'block-3': deflateSync(bytes).toString('base64') });
  assert.deepEqual(await readBlock(3, root), bytes);
});

test('a broken block is an error, not a cloud of nonsense', async () => {
  const packed = deflateSync(Uint8Array.from({ length: 1000 }, (_, i) => i & 255));
  packed[packed.length - 1] ^= 1;
  await assert.rejects(readBlock(0, documentWith({ 'block-0': packed.toString('base64') })));
});

test('content is the JSON in the page, escapes undone', () => {
  assert.deepEqual(readContent(documentWith({ report: '{"a":"\\u003c/script>"}' })), { a: '</script>' });
});
