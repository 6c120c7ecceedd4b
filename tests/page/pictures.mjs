// Compares screenshots with the kept ones in tests/page/pictures. MOSBENCH_UPDATE_PICTURES=1 keeps
// what is seen now instead; look at them before committing.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { artefacts } from './reports.mjs';

const KEPT = new URL('pictures/', import.meta.url).pathname;
const BLOCK = 8; // pixels: letters may move by one, an object may not
const MEAN_LEVELS = 4; // of 255, over the whole picture
const SHARE_OF_BLOCKS = 0.02; // that may differ by more than ...
const BLOCK_LEVELS = 40;

/** Mean level of each block of BLOCK x BLOCK pixels, per colour, read by the browser itself. */
function blockLevels(page, png, as = null) {
  return page.evaluate(async ([base64, block, as]) => {
    const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const [width, height] = (as ?? [picture.width, picture.height]).map((pixels) => Math.ceil(pixels / block));
    const canvas = new OffscreenCanvas(width * block, height * block);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const levels = new Array(3 * width * height).fill(0);
    for (let i = 0; i < data.length; i += 4) {
      const [x, y] = [(i / 4) % canvas.width, Math.floor(i / 4 / canvas.width)];
      const at = 3 * (Math.floor(y / block) * width + Math.floor(x / block));
      for (let c = 0; c < 3; ++c) levels[at + c] += data[i + c] / (block * block);
    }
    return { size: [picture.width, picture.height], levels };
  }, [png.toString('base64'), BLOCK, as]);
}

/** Shows two pictures of one size as alike within the tolerance, or fails with how they differ. */
export async function assertLooksLikeKept(browser, name, png) {
  writeFileSync(join(artefacts(), `${name}.png`), png);
  const kept = join(KEPT, `${name}.png`);
  if (process.env.MOSBENCH_UPDATE_PICTURES) {
    mkdirSync(KEPT, { recursive: true });
    writeFileSync(kept, png);
    return;
  }
  assert.ok(existsSync(kept), `${kept} is missing`);
  const page = await browser.newPage();
  const expected = await blockLevels(page, readFileSync(kept));
  const seen = await blockLevels(page, png, expected.size);
  await page.close();
  // A part of a page that begins between two pixels is cut a pixel more or less.
  const isAlike = seen.size.every((pixels, i) => Math.abs(pixels - expected.size[i]) <= 1);
  assert.ok(isAlike, `${name}: ${seen.size} pixels, expected ${expected.size}`);
  const differences = seen.levels.map((level, i) => Math.abs(level - expected.levels[i]));
  const mean = differences.reduce((a, b) => a + b, 0) / differences.length;
  const share = differences.filter((d) => d > BLOCK_LEVELS).length / differences.length;
  assert.ok(mean < MEAN_LEVELS && share < SHARE_OF_BLOCKS, `${name}: differs by ${mean.toFixed(2)} levels, ${(100 * share).toFixed(1)} % of blocks`);
}
