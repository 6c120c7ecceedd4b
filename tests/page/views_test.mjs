// What a reader sees and does: views, charts, keys, two runs side by side, phone and desktop.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { DESKTOP, PHONE, openBrowser, openReport, refuseComplaints, settled } from './browser.mjs';
import { assertLooksLikeKept } from './pictures.mjs';
import { artefacts, freshFolder, mosbench, resultOf, runWithFoundPoses, scoresOf, simulatedRuns } from './reports.mjs';

const folder = freshFolder();
const both = join(folder, 'both.html');
let browser, online, delayed;

before(async () => {
  const runs = simulatedRuns(folder);
  mosbench('report', ...runs, '-o', both);
  [online, delayed] = runs.map((run) => resultOf(join(run, '06')));
  browser = await openBrowser();
});
after(() => browser.close());

/** The report with the first run alone in the 3-D view. */
async function openAlone(options) {
  const page = await openReport(browser, both, options);
  await page.evaluate(() => mosbenchReport.state.set({ others: [] }));
  return page;
}

/** Ticks or unticks a run in the menu of the 3-D view. */
async function beside(page, run) {
  await page.click('.toolbar .menu summary');
  await page.click(`.toolbar .menu-list label:has-text("${run}")`);
  await page.click('.toolbar .menu summary');
}

/** Unticks every run beside the chosen one in the charts. */
async function chartsAlone(page) {
  await page.click('.charts .menu summary');
  for (const box of await page.locator('.charts .menu-list :checked').all()) await box.click();
}

const STAGE = { width: 480, height: 700 };

async function shot(page, name) {
  await settled(page);
  await assertLooksLikeKept(browser, name, await page.locator('.stage').screenshot());
}

test('each view shows what it showed before', async () => {
  const page = await openAlone({ viewport: { width: 700, height: 640 } });
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21 }));
  for (const view of ['orbit', 'top', 'sensor', 'map']) {
    await page.click(`[data-view=${view}]`);
    await shot(page, `view_${view}`);
  }
  refuseComplaints(page);
});

test('colours by height, the dark theme and two runs side by side show what they showed before', async () => {
  const page = await openAlone({ viewport: { width: 700, height: 640 }, theme: 'dark' });
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21, view: 'top' }));
  await shot(page, 'dark_top');
  await page.selectOption('[aria-label=colour]', 'height');
  await shot(page, 'dark_height');
  await page.selectOption('[aria-label=colour]', 'outcome');
  await beside(page, 'delayed');
  await shot(page, 'dark_side_by_side');
  refuseComplaints(page);
});

test('boxes surround what moves, with speeds, until they are switched off', async () => {
  const page = await openAlone({ viewport: { width: 700, height: 640 } });
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21 }));
  assert.equal(await page.locator('.speeds span').count(), 0);
  await page.click('button:text-is("boxes")');
  await shot(page, 'boxes');
  const boxes = await page.evaluate(() => mosbenchReport.viewer.scans[0].boxes);
  assert.ok(boxes.some(([, , , , , , , speed]) => speed > 0.5), 'something moves');
  const texts = await page.locator('.speeds span').allTextContents();
  assert.deepEqual(texts, boxes.map(([, , , , , , , speed]) => (speed === null ? '' : `${speed.toFixed(1)} m/s`)));
  const place = () => page.locator('.speeds span').first().evaluate(({ style }) => style.left + style.top + style.display);
  const before = await place();
  await page.click('[data-view=top]');
  await settled(page);
  assert.notEqual(await place(), before, 'the speeds follow the camera');
  await page.keyboard.press('b');
  await settled(page);
  assert.equal(await page.locator('.speeds span').count(), 0);
  refuseComplaints(page);
});

test('two runs stay in step, each with its own counts', async () => {
  const page = await openAlone({ viewport: STAGE });
  await beside(page, 'delayed');
  const differing = online.scans.findIndex(({ fn }, k) => k > 0 && fn !== delayed.scans[k].fn);
  assert.ok(differing > 0, 'the runs differ somewhere');
  await page.evaluate((scan) => mosbenchReport.transport.go(scan), differing - 1);
  await page.keyboard.press('ArrowRight');
  await settled(page);
  const counts = await page.locator('[data-outcome=fn] .counts').textContent();
  assert.equal(counts, [online, delayed].map(({ scans }) => scans[differing].fn.toLocaleString('en-US')).join(' · '));
  refuseComplaints(page);
});

test('colours by dynamic score tell those of the score files, with a key to them', async () => {
  const page = await openAlone({ viewport: { width: 700, height: 640 } });
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21, view: 'top' }));
  await page.selectOption('[aria-label=colour]', 'score');
  await shot(page, 'score_top');
  const { stem, threshold } = online.scans[21];
  const scores = scoresOf(join(folder, 'online', '06'), stem);
  const without = scores.filter((score) => score === 0).length;
  assert.ok(without > 0 && without < scores.length && threshold > 3, 'the scan has votes for motion');
  const shown = await page.evaluate(() => mosbenchReport.viewer.coloursShown());
  assert.equal(shown['207,213,220'], without);
  assert.match(await page.locator('.scale').textContent(), new RegExp(`^dynamic scorenone1\\d+Otsu threshold ${threshold.toFixed(0)}$`));
  await page.keyboard.press('t');
  await shot(page, 'score_top_dark');
  refuseComplaints(page);
});

test('dynamic scores are not offered beside a run without them, which is told how to get them', async () => {
  const page = await openAlone({ viewport: STAGE });
  await page.selectOption('[aria-label=colour]', 'score');
  await beside(page, 'delayed');
  await settled(page);
  assert.equal(await page.evaluate(() => mosbenchReport.state.get('colouring')), 'outcome');
  assert.equal(await page.locator('[aria-label=colour] option[disabled]').textContent(), 'dynamic score: needs mosbench run --write scores');
  await beside(page, 'delayed');
  assert.equal(await page.locator('[aria-label=colour] option[value=score][disabled]').count(), 0);
  refuseComplaints(page);
});

test('charts over the scans hold the numbers of both runs', async () => {
  const page = await openReport(browser, both);
  const numbers = await page.evaluate(() => Object.fromEntries(mosbenchReport.charts.charts.map((chart) => [chart.key, chart.numbers()])));
  const ofBoth = (number) => ({ online: online.scans.map(number), delayed: delayed.scans.map(number) });
  assert.deepEqual(numbers.fp, ofBoth(({ fp }) => fp));
  assert.deepEqual(numbers.fn, ofBoth(({ fn }) => fn));
  assert.deepEqual(numbers.iou, ofBoth(({ tp, fp, fn }) => (tp + fp + fn > 0 ? tp / (tp + fp + fn) : null)));
  assert.deepEqual(numbers.threshold, ofBoth(({ threshold }) => threshold));
  const push = ({ timing }) => timing.scans.map((row) => row[timing.scan_columns.indexOf('push_ms')]);
  assert.deepEqual(numbers.time, { online: push(online), delayed: push(delayed) });
  assert.match(await page.locator('[data-chart=iou] .u-legend').textContent(), /online.*delayed/s);
  writeFileSync(join(artefacts(), 'charts_of_two.png'), await page.locator('.charts').screenshot());
  refuseComplaints(page);
});

test('charts hold the numbers of result.json', async () => {
  const page = await openReport(browser, both);
  await chartsAlone(page);
  const numbers = await page.evaluate(() => Object.fromEntries(mosbenchReport.charts.charts.map((chart) => [chart.key, chart.numbers()])));
  const of = (key) => online.scans.map((scan) => scan[key]);
  assert.deepEqual(numbers.counts, { TP: of('tp'), FP: of('fp'), FN: of('fn') });
  assert.deepEqual(numbers.threshold, { threshold: of('threshold') });
  const expected = online.scans.map(({ tp, fp, fn }) => (tp + fp + fn > 0 ? tp / (tp + fp + fn) : null));
  assert.deepEqual(numbers.metrics.IoU, expected);
  assert.equal(numbers.metrics['IoU of all'][0], online.summary.iou);
  const { scan_columns: columns, scans } = online.timing;
  const column = (name) => scans.map((row) => row[columns.indexOf(name)]);
  assert.deepEqual(numbers.memory.resident, column('resident_mib'));
  for (const name of columns.slice(3)) assert.deepEqual(numbers.stages[name.slice(0, -3).replace('_', ' ')], column(name), name);
  refuseComplaints(page);
});

test('intervals, ranges, objects and protocols are those that the program tells', async () => {
  const page = await openAlone({});
  const content = await page.evaluate(() => mosbenchReport.content.results[0]);
  const answer = (...args) => JSON.parse(mosbench(...args, '--json'));
  const [run, dataset] = [join(folder, 'online'), join(folder, 'sim')];
  assert.deepEqual(content.estimates.iou, answer('stats', run).sequences[0].metrics.iou);
  const why = content.estimates.iou.no_interval;
  assert.ok(why, 'so few scans have no interval');
  assert.ok((await page.locator('.tiles').textContent()).includes(`no interval: ${why}`));
  assert.equal(await page.locator('.block:has(h2:text-is("Results"))').getByTitle(`no interval: ${why}`).first().textContent(), `${(100 * content.estimates.iou.value).toFixed(1)} % no interval`);
  const breakdown = answer('breakdown', dataset, '--predictions', run, '--top', '50').sequences[0];
  assert.deepEqual(content.breakdown, breakdown);
  const own = content.protocols.find(({ name }) => name === online.protocol.name);
  assert.equal(own.iou, online.summary.iou);
  const ranges = await page.evaluate(() => mosbenchReport.charts.numbers('range'));
  assert.equal(ranges.TP.reduce((a, b) => a + b), online.summary.tp);
  assert.equal(ranges.FN.reduce((a, b) => a + b), online.summary.fn);
  const objects = await page.evaluate(() => mosbenchReport.charts.numbers('objects'));
  assert.deepEqual([...objects.recall].sort(), breakdown.objects.map(({ recall }) => recall).sort());
  assert.ok(await page.getByText('Worst objects').isVisible());
  refuseComplaints(page);
});

test('the way of the sensor stands beside that of the data set, with the distance over the way driven', async () => {
  const report = join(folder, 'found.html');
  mosbench('report', join(folder, 'online'), runWithFoundPoses(folder), '-o', report, '--scans', '0-2');
  const page = await openReport(browser, report, { viewport: { width: 700, height: 640 } });
  const numbers = (key) => page.evaluate((k) => mosbenchReport.charts.numbers(k), key);
  const scores = JSON.parse(mosbench('trajectory', join(folder, 'found'), '--truth', join(folder, 'sim'), '--align', 'origin', '--json', '--per-pose'));
  const off = scores.sequences[0].per_pose.translation_m.map((m) => Math.round(1000 * m) / 1000);
  assert.ok(Math.max(...off) > 0, 'odometry is not exact');
  assert.deepEqual(await numbers('drift'), { found: off });
  const both_paths = await numbers('path');
  assert.deepEqual(Object.keys(both_paths), ['poses of the data set', 'online', 'found']);
  assert.deepEqual(both_paths.online, both_paths['poses of the data set']);
  assert.equal(await page.locator('[data-chart=path] polyline').count(), 3);
  const dot = () => page.locator('[data-chart=path] circle').first().evaluate((c) => [c.getAttribute('cx'), -c.getAttribute('cy')].map(Number));
  await page.evaluate(() => mosbenchReport.transport.go(2));
  assert.deepEqual(await dot(), both_paths.online[2]);
  await assertLooksLikeKept(browser, 'path', await page.locator('[data-chart=path]').screenshot());
  await chartsAlone(page);
  assert.equal(await numbers('drift'), null);
  refuseComplaints(page);
});

test('a click into a chart moves the 3-D view to that scan', async () => {
  const page = await openReport(browser, both);
  const chart = page.locator('[data-chart=fn] .u-over');
  await chart.scrollIntoViewIfNeeded();
  const { width, height } = await chart.boundingBox();
  await chart.click({ position: { x: width - 2, y: height / 2 } });
  assert.equal(await page.evaluate(() => mosbenchReport.state.get('scan')), online.scans.length - 1);
  refuseComplaints(page);
});

test('two runs are side by side from the start, in a typical scan, with the numbers of both', async () => {
  const page = await openReport(browser, both, { viewport: STAGE });
  await settled(page);
  assert.deepEqual(await page.evaluate(() => mosbenchReport.viewer.names()), ['online', 'delayed']);
  const scan = await page.evaluate(() => mosbenchReport.state.get('scan'));
  const idle = new Set(online.scans_without_detection);
  const telling = online.scans.filter((s) => !idle.has(s.stem) && s.tp + s.fn > 0).map(({ tp, fp, fn }) => tp / (tp + fp + fn));
  const iou = ({ tp, fp, fn }) => tp / (tp + fp + fn);
  assert.equal(iou(online.scans[scan]), telling.sort((a, b) => a - b)[Math.floor(telling.length / 2)]);
  const shown = await page.locator('.tile').first().textContent();
  assert.equal(shown, `IoU${[online, delayed].map(({ summary }, i) => `${['online', 'delayed'][i]}${(100 * summary.iou).toFixed(1)} %`).join('')}`);
  const [legend, screen] = await Promise.all(['.legend', '.screen'].map((part) => page.locator(part).boundingBox()));
  assert.ok(legend.y >= screen.y + screen.height - 1, 'the legend covers no pane');
  refuseComplaints(page);
});

test('a link leads back to run, scan and camera', async () => {
  const page = await openAlone({ viewport: STAGE });
  await page.evaluate(() => mosbenchReport.state.set({ result: 1, scan: 20, view: 'orbit' }));
  await settled(page);
  await page.evaluate(() => mosbenchReport.viewer.lookFrom({ eye: [-5, 6, 7], target: [1, 2, 3] }));
  await page.click('text=copy link');
  const hash = await page.evaluate(() => location.hash);
  assert.equal(hash, '#result=1&scan=20&view=orbit&colour=outcome&eye=-5,6,7&target=1,2,3');
  await page.evaluate(() => { mosbenchReport.state.set({ result: 0, scan: 3, view: 'top' }); location.hash = ''; });
  await settled(page);
  await page.evaluate((link) => (location.hash = link), hash);
  await page.waitForFunction(() => mosbenchReport.state.get('scan') === 20);
  await settled(page);
  const camera = await page.evaluate(() => mosbenchReport.viewer.stage.camera_m());
  assert.deepEqual([camera.eye, camera.target].map((p) => p.map((m) => Number(m.toFixed(3)))), [[-5, 6, 7], [1, 2, 3]]);
  refuseComplaints(page);
});

/** How opaque each pixel of a PNG is, row by row. */
async function alphasOf(png) {
  const blank = await browser.newPage(); // a report may fetch nothing
  const alphas = await blank.evaluate(async (base64) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const alphas = context.getImageData(0, 0, image.width, image.height).data.filter((_, i) => i % 4 === 3);
    const url = await new Promise((done) => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result);
      reader.readAsDataURL(new Blob([alphas]));
    });
    return url.slice(url.indexOf(',') + 1); // a million numbers would take 20 s to pass
  }, png.toString('base64'));
  await blank.close();
  return Buffer.from(alphas, 'base64');
}

async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
  const file = join(artefacts(), download.suggestedFilename());
  await download.saveAs(file);
  return { name: download.suggestedFilename(), bytes: readFileSync(file) };
}

test('speeds of boxes stand in a saved picture where the page has them', async () => {
  const page = await openAlone({ viewport: STAGE });
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21, boxes: true }));
  await settled(page);
  const places = await page.evaluate(() => {
    const stage = document.querySelector('.stage canvas').getBoundingClientRect();
    return [...document.querySelectorAll('.speeds span')].filter((span) => span.textContent && span.style.display !== 'none').map((span) => {
      const { left, top, width, height } = span.getBoundingClientRect();
      return { left: left - stage.left, top: top - stage.top, width, height };
    });
  });
  assert.ok(places.length > 0, 'a speed is in sight');
  const { bytes } = await saved(page, page.locator('text=save picture'));
  const [alphas, columns] = [await alphasOf(bytes), bytes.readUInt32BE(16)];
  const alphaAt = (x, y) => alphas[Math.round(2 * y) * columns + Math.round(2 * x)];
  for (const { left, top, width, height } of places) {
    for (const [x, y] of [[left + 1, top + 1], [left + width - 2, top + height - 2]]) assert.ok(alphaAt(x, y) > 200, `${x} ${y}: ${alphaAt(x, y)}`);
  }
  refuseComplaints(page);
});

test('pictures are saved twice as large without background, charts as drawings', async () => {
  const page = await openAlone({ viewport: STAGE });
  await settled(page);
  const picture = await saved(page, page.locator('text=save picture'));
  assert.match(picture.name, /^online_06_\d{6}_orbit\.png$/);
  const canvas = await page.locator('.stage canvas').boundingBox();
  assert.deepEqual([16, 20].map((at) => picture.bytes.readUInt32BE(at)), [2 * Math.floor(canvas.width), 2 * Math.floor(canvas.height)]);
  const alphas = await alphasOf(picture.bytes);
  const clear = { none: alphas.filter((a) => a === 0).length / alphas.length, full: alphas.filter((a) => a === 255).length };
  assert.ok(clear.none > 0.3 && clear.full > 1000, JSON.stringify(clear));
  for (const [key, part] of [['iou', '<polyline'], ['range', '<rect'], ['path', '<polyline']]) {
    const drawing = await saved(page, page.locator(`[data-chart=${key}] .save`));
    assert.equal(drawing.name, `${key}.svg`);
    assert.ok(drawing.bytes.toString().startsWith('<svg xmlns="http://www.w3.org/2000/svg"') && drawing.bytes.includes(part), key);
    assert.ok(!/NaN|undefined/.test(drawing.bytes.toString()), key);
  }
  refuseComplaints(page);
});

test('charts hold no placeholders, and a motion map that is left says nothing more', async () => {
  const page = await openAlone({ viewport: STAGE });
  assert.equal(await page.locator('.chart .u-value').first().evaluate((cell) => getComputedStyle(cell).visibility), 'hidden');
  await page.click('[data-view=map]');
  await page.click('[data-view=orbit]');
  await settled(page);
  await page.evaluate(() => new Promise((done) => setTimeout(done, 300)));
  assert.equal(await page.locator('.busy').textContent(), '');
  await page.click('[data-view=map]');
  await settled(page);
  const [moving, still] = await page.evaluate(() => mosbenchReport.viewer.scans.map(({ points, context }) => [points, context.length / 3])[0]);
  assert.ok(moving > 0 && still > 1000, `${moving} ${still}`);
  refuseComplaints(page);
});

test('keys change view, colour, theme and scan, and play goes on by itself', async () => {
  const page = await openAlone({ viewport: STAGE });
  const state = (key) => page.evaluate((k) => mosbenchReport.state.get(k), key);
  await page.keyboard.press('2');
  assert.equal(await state('view'), 'top');
  await page.keyboard.press('c');
  assert.equal(await state('colouring'), 'range');
  await page.keyboard.press('t');
  assert.equal(await state('theme'), 'dark');
  await page.keyboard.press('Home');
  assert.equal(await state('scan'), 0);
  await page.keyboard.press(' ');
  await page.waitForFunction(() => mosbenchReport.state.get('scan') > 1);
  await page.keyboard.press(' ');
  await page.keyboard.press('End');
  assert.equal(await state('scan'), online.scans.length - 1);
  refuseComplaints(page);
});

test('a click on a point shows its numbers', async () => {
  const page = await openAlone({ viewport: STAGE });
  await page.evaluate(() => mosbenchReport.state.set({ view: 'top' }));
  await settled(page);
  const spot = await page.evaluate(() => {
    const { viewer } = mosbenchReport;
    const { positions_m: p, outcomes, drawable } = viewer.scans[0];
    const clip = viewer.stage.clipMatrix();
    const { width, height } = viewer.stage.grid();
    for (let i = 0; i < outcomes.length; ++i) {
      const [x, y, z] = p.subarray(3 * i, 3 * i + 3);
      const row = (r) => clip[r] * x + clip[4 + r] * y + clip[8 + r] * z + clip[12 + r];
      const at = { x: ((row(0) / row(3) + 1) / 2) * width, y: ((1 - row(1) / row(3)) / 2) * height };
      const inside = at.x > 20 && at.x < width - 20 && at.y > 20 && at.y < height - 150;
      if (drawable[i] && outcomes[i] !== 3 && inside) return at;
    }
    return null;
  });
  assert.ok(spot, 'a point of a moving object is in view');
  await page.locator('.stage canvas').click({ position: spot });
  assert.match(await page.locator('.details').textContent(), /point\d+ of \d+, scan \d+.*range\d+\.\d\d m.*outcome(true|false) (positive|negative).*dynamic score\d+$/);
  const [point, score] = (await page.locator('.details').textContent()).match(/^point(\d+) .*dynamic score(\d+)$/).slice(1).map(Number);
  const { stem } = online.scans[await page.evaluate(() => mosbenchReport.state.get('scan'))];
  assert.equal(score, scoresOf(join(folder, 'online', '06'), stem)[point]);
  refuseComplaints(page);
});

test('everything is readable on desktop and phone, light and dark', async () => {
  for (const [size, viewport] of Object.entries({ desktop: DESKTOP, phone: PHONE })) {
    for (const theme of ['light', 'dark']) {
      const page = await openReport(browser, both, { viewport, theme });
      await settled(page);
      const sideways = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.equal(sideways, 0, `${size}: the page scrolls sideways`);
      const { y } = await page.locator('.stage').boundingBox();
      assert.ok(y < (size === 'phone' ? 0.45 : 0.55) * viewport.height, `${size}: the picture begins at ${y}`);
      writeFileSync(join(artefacts(), `page_${size}_${theme}.png`), await page.screenshot({ fullPage: true }));
      refuseComplaints(page);
      await page.context().close();
    }
  }
});
