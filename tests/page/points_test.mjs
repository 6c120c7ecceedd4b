// The 3-D view shows what result.json counts.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser, openReport, refuseComplaints, settled } from './browser.mjs';
import { freshFolder, mosbench, realSequence, resultOf, simulatedRuns } from './reports.mjs';
import palette from '../../eval/report/page/palette.json' with { type: 'json' };

// Pictures are drawn without a graphics card here: small ones are enough to count by.
const SMALL = { width: 480, height: 420 };

const folder = freshFolder();
let browser;
before(async () => (browser = await openBrowser()));
after(() => browser.close());

const colour = (key) => {
  const { light } = palette.outcomes.find((outcome) => outcome.key === key);
  return [1, 3, 5].map((i) => parseInt(light.slice(i, i + 2), 16)).join(',');
};

function coloursOf(shown) {
  const of = (key) => shown[colour(key)] ?? 0;
  return { tp: of('tp'), fp: of('fp'), fn: of('fn'), tn: of('tn'), ignored: of('unlabelled') + of('unlabelled_moving') };
}

function countsOf({ tp, fp, fn, tn, ignored }) {
  return { tp, fp, fn, tn, ignored };
}

async function everyScanShowsItsCounts(page, result) {
  await page.keyboard.press('Home');
  for (let k = 0; k < result.scans.length; ++k) {
    await settled(page);
    assert.equal(await page.evaluate(() => mosbenchReport.state.get('scan')), k);
    const shown = await page.evaluate(() => mosbenchReport.viewer.coloursShown());
    assert.deepEqual(coloursOf(shown), countsOf(result.scans[k]), `scan ${k}`);
    await page.keyboard.press('ArrowRight');
  }
}

test('points of each colour equal the counts of result.json, scan by scan', async () => {
  const [online] = simulatedRuns(folder);
  const file = join(folder, 'simulated.html');
  mosbench('report', online, '-o', file);
  const result = resultOf(join(online, '06'));
  assert.ok(result.summary.tp > 0 && result.summary.fn > 0, 'the simulated run has true and false points');
  const page = await openReport(browser, file, { viewport: SMALL });
  await everyScanShowsItsCounts(page, result);
  refuseComplaints(page);
});

test('points of each colour equal the counts on the real KITTI drive 0005', { skip: !realSequence() && 'the parity cases are not there' }, async () => {
  const run = join(folder, 'kitti');
  const file = join(folder, 'kitti.html');
  mosbench('run', realSequence(), '--set', 'max_range_m=50', '--out', run);
  mosbench('report', run, '-o', file);
  const result = resultOf(join(run, 'kitti_0005'));
  const page = await openReport(browser, file, { viewport: SMALL });
  await everyScanShowsItsCounts(page, result);
  refuseComplaints(page);
});
