// The 3-D view shows what result.json counts.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser, openReport, refuseComplaints, settled } from './browser.mjs';
import { artefacts, freshFolder, mosbench, realSequence, resultOf, simulatedRuns } from './reports.mjs';
import palette from '../../eval/report/page/palette.json' with { type: 'json' };

// Pictures are drawn without a graphics card here: small ones are enough to count by.
const SMALL = { width: 480, height: 420 };

const folder = freshFolder();
let browser;
before(async () => (browser = await openBrowser()));
after(() => browser.close());

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)).join(',');
const colour = (key) => rgb(palette.outcomes.find((outcome) => outcome.key === key).light);

function coloursOf(shown) {
  const of = (key) => shown[colour(key)] ?? 0;
  return { tp: of('tp'), fp: of('fp'), fn: of('fn'), tn: of('tn'), ignored: of('unlabelled') + of('unlabelled_moving') };
}

function countsOf({ tp, fp, fn, tn, ignored }) {
  return { tp, fp, fn, tn, ignored };
}

async function scanShowsItsCounts(page, result, k) {
  await settled(page);
  assert.equal(await page.evaluate(() => mosbenchReport.state.get('scan')), k);
  const shown = await page.evaluate(() => mosbenchReport.viewer.coloursShown());
  assert.deepEqual(coloursOf(shown), countsOf(result.scans[k]), `scan ${k}`);
}

test('points of each colour equal the counts of result.json, scan by scan', async () => {
  const [online] = simulatedRuns(folder);
  const file = join(folder, 'simulated.html');
  mosbench('report', online, '-o', file);
  const result = resultOf(join(online, '06'));
  assert.ok(result.summary.tp > 0 && result.summary.fn > 0, 'the simulated run has true and false points');
  const page = await openReport(browser, file, { viewport: SMALL });
  await page.keyboard.press('Home');
  for (let k = 0; k < result.scans.length; ++k, await page.keyboard.press('ArrowRight')) await scanShowsItsCounts(page, result, k);
  refuseComplaints(page);
});

test('points of each colour equal the counts on the real KITTI drive 0005', { skip: !realSequence() && 'the parity cases are not there' }, async () => {
  const run = join(folder, 'kitti');
  const file = join(folder, 'kitti.html');
  mosbench('run', realSequence(), '--set', 'max_range_m=50', '--out', run);
  mosbench('report', run, '-o', file);
  const result = resultOf(join(run, 'kitti_0005'));
  const page = await openReport(browser, file, { viewport: SMALL });
  for (let k = 0; k < result.scans.length; k += 6) {
    await page.evaluate((scan) => mosbenchReport.transport.go(scan), k);
    await scanShowsItsCounts(page, result, k);
  }
  refuseComplaints(page);
});

test('points of each reason equal those of the reason files, with a key to the colours', async () => {
  simulatedRuns(folder);
  const seen = palette.reasons.map(() => 0);
  // Only a delayed run knows what left free space behind, only one without delay expects objects.
  for (const delay of [0, 8]) {
    const run = join(folder, `best_${delay}`);
    const file = join(folder, `best_${delay}.html`);
    mosbench('run', join(folder, 'sim'), '--preset', 'best', '--set', `delay_scans=${delay}`, '--scores', '--out', run);
    mosbench('report', run, '-o', file);
    const page = await openReport(browser, file, { viewport: SMALL });
    await page.selectOption('[aria-label=colour]', 'reason');
    assert.equal(await page.locator('.scale').textContent(), palette.reasons.map(({ name }) => name).join(''));
    for (const [scan, { stem }] of resultOf(join(run, '06')).scans.entries()) {
      await page.evaluate((k) => mosbenchReport.transport.go(k), scan);
      await settled(page);
      const expected = palette.reasons.map(() => 0);
      for (const reason of readFileSync(join(run, '06', 'reasons', `${stem}.reason`))) ++expected[reason];
      const shown = await page.evaluate(() => mosbenchReport.viewer.coloursShown());
      assert.deepEqual(palette.reasons.map(({ light }) => shown[rgb(light)] ?? 0), expected, `scan ${scan}`);
      expected.forEach((points, reason) => (seen[reason] += points));
    }
    await page.screenshot({ path: join(artefacts(), `reasons_${delay}.png`) });
    refuseComplaints(page);
  }
  assert.ok(seen.every((points) => points > 0), `each reason is there: ${seen}`);
});
