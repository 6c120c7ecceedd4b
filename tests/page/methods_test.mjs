// Reports of several methods: leaderboard, curves, up to six runs side by side, where they disagree.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { DESKTOP, PHONE, openBrowser, openReport, refuseComplaints, settled } from './browser.mjs';
import { assertLooksLikeKept } from './pictures.mjs';
import { artefacts, freshFolder, mosbench, resultOf } from './reports.mjs';

const METHODS = ['hmm-mos', 'hmm-mos-plus', 'dynablox', 'underwood', 'dufomap', 'yoon'];
const folder = freshFolder();
const [all, net, file] = ['all', 'net', 'all.html'].map((name) => join(folder, name));
const SMALL = { width: 700, height: 640 };
let browser;

before(async () => {
  mosbench('simulate', '--layout', 'sipailou', '--scene', 'campus', '--scans', '24', '--seed', '1', '--out', join(folder, 'sim'));
  mosbench('run', join(folder, 'sim'), '--method', METHODS.join(), '--scores', '--out', all);
  mosbench('run', join(folder, 'sim'), '--set', 'delay_scans=4', '--out', join(all, 'delayed'));
  mosbench('score', join(folder, 'sim'), '--predictions', join(all, 'yoon'), '--method', 'Net', '--out', net);
  mosbench('report', all, net, '-o', file, '--scans', '20-22');
  browser = await openBrowser();
});
after(() => browser.close());

async function beside(page, ...runs) {
  await page.click('.toolbar .menu summary');
  for (const run of runs) await page.click(`.toolbar .menu-list label:has-text("${run}")`);
  await page.click('.toolbar .menu summary');
  await settled(page);
}

/** Looks at a run and a scan of it. */
function look(page, run, scan = 21) {
  return page.evaluate(([name, k]) => {
    const { content, state } = mosbenchReport;
    state.set({ result: content.results.findIndex((entry) => entry.run === name), others: [], scan: k, view: 'top' });
  }, [run, scan]);
}

test('the leaderboard has the numbers of mosbench rank, and its rows lead to the runs', async () => {
  const page = await openReport(browser, file);
  const { rows } = JSON.parse(mosbench('rank', all, net, '--format', 'json'));
  const lines = page.locator('.leaderboard tbody tr');
  assert.equal(await lines.count(), rows.length);
  for (const [r, row] of rows.entries()) {
    const cells = await lines.nth(r).locator('td').allTextContents();
    assert.ok(cells[1].startsWith(row.method), cells[1]);
    assert.ok(cells[3].startsWith(`${(100 * row.all.iou.value).toFixed(1)} %`), cells[3]);
    assert.equal(cells[8] === '★', row.on_front);
    if (r > 0) assert.ok(cells[9].startsWith(`−${Math.abs(100 * row.to_first.value).toFixed(1)}`) || row.to_first.value === 0, cells[9]);
  }
  await lines.filter({ hasText: 'DUFOMap' }).click();
  assert.equal(await page.locator('[aria-label=Result] option:checked').textContent(), 'dufomap · 06');
  assert.match(await page.locator('[aria-current]').textContent(), /DUFOMap/);
  await lines.filter({ hasText: 'Net' }).click();
  await settled(page);
  await page.evaluate(() => mosbenchReport.state.set({ scan: 21 }));
  await settled(page);
  const ofNet = await page.evaluate(() => mosbenchReport.viewer.coloursShown());
  await look(page, 'yoon');
  await settled(page);
  assert.deepEqual(ofNet, await page.evaluate(() => mosbenchReport.viewer.coloursShown()), 'they are the same labels');
  refuseComplaints(page);
});

test('every run with scores has its curve and the precision that mosbench curve tells', async () => {
  const page = await openReport(browser, file);
  const numbers = await page.evaluate(() => mosbenchReport.charts.numbers('curve'));
  assert.equal(Object.keys(numbers).length, METHODS.length);
  for (const method of METHODS) {
    const { average_precision: ap } = JSON.parse(mosbench('curve', join(all, method), '--format', 'json'));
    assert.ok(`${method}, AP ${(100 * ap).toFixed(1)} %` in numbers, `${method}: ${Object.keys(numbers)}`);
  }
  const chart = page.locator('[data-chart=curve]');
  await chart.scrollIntoViewIfNeeded();
  writeFileSync(join(artefacts(), 'curves.png'), await chart.screenshot());
  refuseComplaints(page);
});

test('up to six runs stand side by side, each with its own counts', async () => {
  const page = await openReport(browser, file, { viewport: SMALL });
  await look(page, 'hmm-mos');
  await beside(page, 'hmm-mos-plus', 'dynablox', 'underwood', 'dufomap', 'yoon');
  assert.equal(await page.locator('.toolbar .menu-list :disabled').count(), 2, 'a seventh run has no place');
  const shown = await page.locator('.pane').allTextContents();
  assert.equal(shown.length, 6);
  for (const [p, method] of METHODS.entries()) {
    const { tp, fp, fn } = resultOf(join(all, method, '06')).scans[21];
    assert.equal(shown[p], `${method}TP ${tp.toLocaleString('en-US')} · FP ${fp.toLocaleString('en-US')} · FN ${fn.toLocaleString('en-US')}`);
  }
  const iou = await page.evaluate(() => mosbenchReport.charts.numbers('iou'));
  assert.deepEqual(Object.keys(iou), METHODS, 'the charts are of the same runs');
  assert.equal(await page.evaluate(() => mosbenchReport.charts.numbers('threshold')), null, 'their thresholds are of different kinds');
  await assertLooksLikeKept(browser, 'six_runs', await page.locator('.stage').screenshot());
  refuseComplaints(page);
});

test('the colour tells where two runs disagree, and in how many points', async () => {
  const page = await openReport(browser, file, { viewport: SMALL });
  await look(page, 'hmm-mos');
  const option = page.locator('[aria-label=colour] option[value=disagreement]');
  assert.equal(await option.textContent(), 'disagreement: needs a run beside');
  await beside(page, 'dynablox');
  await page.selectOption('[aria-label=colour]', 'disagreement');
  await settled(page);
  assert.equal(await page.locator('.scale').textContent(), 'moving in bothmoving in hmm-mos alonemoving in dynablox alonestatic in both');
  const [a, b] = await page.evaluate(() => [0, 1].map((pane) => mosbenchReport.viewer.coloursShown(pane)));
  assert.deepEqual(a, b, 'both panes show the same opinions');
  const calls = ({ tp, fp }) => tp + fp;
  const [mine, other] = ['hmm-mos', 'dynablox'].map((method) => resultOf(join(all, method, '06')).scans[21]);
  const [blue, orange, purple] = ['0,114,178', '232,89,12', '138,30,224'].map((colour) => a[colour] ?? 0);
  assert.ok(orange + purple > 0, 'they disagree somewhere');
  assert.deepEqual([blue + orange, blue + purple], [calls(mine), calls(other)]);
  await page.click('[data-view=orbit]');
  await settled(page);
  await assertLooksLikeKept(browser, 'disagreement', await page.locator('.stage').screenshot());
  await page.click('[data-view=map]');
  await settled(page);
  assert.equal(await page.evaluate(() => mosbenchReport.state.get('colouring')), 'outcome');
  refuseComplaints(page);
});

test('scores and thresholds are called what they are, and have no common scale across methods', async () => {
  const page = await openReport(browser, file, { viewport: SMALL });
  const scoreOption = page.locator('[aria-label=colour] option[value=score]');
  for (const [method, name, threshold] of [['underwood', 'margin, m', 'range tolerance, m'], ['dynablox', 'distance to surfaces (tau more if ever-free), m', ''], ['hmm-mos', 'dynamic score', 'Otsu threshold']]) {
    await look(page, method);
    assert.equal(await scoreOption.textContent(), name);
    await page.selectOption('[aria-label=colour]', 'score');
    await settled(page);
    const key = await page.locator('.scale').textContent();
    assert.ok(key.startsWith(name) && (threshold === '' ? !/threshold|tolerance/.test(key) : key.includes(threshold)), key);
  }
  await page.selectOption('[aria-label=colour]', 'outcome');
  await beside(page, 'dynablox');
  assert.equal(await scoreOption.textContent(), 'dynamic score: not of different methods');
  assert.equal(await page.evaluate(() => mosbenchReport.charts.numbers('threshold')), null, 'no chart of thresholds for two methods');
  refuseComplaints(page);
});

test('a report of several methods is readable on desktop and phone', async () => {
  for (const [size, viewport] of Object.entries({ desktop: DESKTOP, phone: PHONE })) {
    const page = await openReport(browser, file, { viewport, theme: size === 'phone' ? 'dark' : 'light' });
    await look(page, 'hmm-mos');
    await beside(page, 'dynablox', 'underwood', 'yoon');
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth), 0, size);
    writeFileSync(join(artefacts(), `methods_${size}.png`), await page.screenshot({ fullPage: true }));
    refuseComplaints(page);
    await page.context().close();
  }
});
