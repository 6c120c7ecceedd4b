// Draws the letters of `mosbench render` into glyphs.pgm: ASCII 32 to 126 side by side, DejaVu Sans
// Mono, white on black. Run with node after scripts/setup.sh --page; the C++ build takes the file as it is.
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const require = createRequire(new URL('../page/package.json', import.meta.url));
const { chromium } = require('playwright-core');
const [WIDTH, HEIGHT, BASELINE, COUNT] = [10, 20, 15, 95];

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--font-render-hinting=none', '--disable-lcd-text'] });
const page = await browser.newPage();
const levels = await page.evaluate(([width, height, baseline, glyphs]) => {
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [width * glyphs, height];
  const context = canvas.getContext('2d');
  context.fillRect(0, 0, canvas.width, height);
  context.fillStyle = 'white';
  context.font = '16px "DejaVu Sans Mono"';
  for (let g = 0; g < glyphs; ++g) context.fillText(String.fromCharCode(32 + g), g * width + 0.2, baseline);
  return [...context.getImageData(0, 0, canvas.width, height).data.filter((_, i) => i % 4 === 0)];
}, [WIDTH, HEIGHT, BASELINE, COUNT]);
await browser.close();
writeFileSync(new URL('glyphs.pgm', import.meta.url), Buffer.concat([Buffer.from(`P5\n${WIDTH * COUNT} ${HEIGHT}\n255\n`), Buffer.from(levels)]));
