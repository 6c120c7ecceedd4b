import assert from 'node:assert/strict';
import { test } from 'node:test';
import palette from '../palette.json' with { type: 'json' };

// Machado, Oliveira and Fernandes 2009, complete protanopia, deuteranopia and tritanopia, linear RGB.
const VISIONS = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
};

const linear = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
const seen = (matrix, rgb) => matrix.map((row) => Math.min(1, Math.max(0, row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])));

function lab([r, g, b]) {
  const f = (t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116);
  const [x, y, z] = [f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047), f(0.2126 * r + 0.7152 * g + 0.0722 * b), f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883)];
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** CIE76 difference; 2.3 is just noticeable. */
function difference(vision, a, b) {
  const [p, q] = [a, b].map((hex) => lab(seen(VISIONS[vision], linear(hex))));
  return Math.hypot(...p.map((v, i) => v - q[i]));
}

for (const theme of ['light', 'dark']) {
  for (const vision of Object.keys(VISIONS)) {
    test(`outcomes are told apart in the ${theme} theme with ${vision}`, () => {
      const { outcomes, background } = palette;
      for (const a of outcomes) {
        assert.ok(difference(vision, a[theme], background[theme]) > 12, `${a.key} on the background`);
        for (const b of outcomes.slice(outcomes.indexOf(a) + 1)) {
          const least = a.key === 'tn' && b.key === 'unlabelled' ? 17 : 25;
          assert.ok(difference(vision, a[theme], b[theme]) > least, `${a.key} and ${b.key}: ${difference(vision, a[theme], b[theme])}`);
        }
      }
    });
    test(`reasons are told apart in the ${theme} theme with ${vision}`, () => {
      const { reasons, background } = palette;
      reasons.forEach((a, i) => {
        assert.ok(difference(vision, a[theme], background[theme]) > 12, `${a.key} on the background`);
        for (const b of reasons.slice(i + 1)) {
          const found = difference(vision, a[theme], b[theme]);
          assert.ok(found > 25, `${a.key} and ${b.key}: ${found}`);
        }
      });
    });
  }
}
