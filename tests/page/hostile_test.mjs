// No string of a result can run as script, whatever it holds.
import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser, openReport, refuseComplaints } from './browser.mjs';
import { freshFolder, mosbench, simulatedRuns } from './reports.mjs';

const EVIL = '</script><script>globalThis.broken = 1</script><img src=x onerror="globalThis.broken = 2"><svg onload=globalThis.broken=3>&quot;\'"`${globalThis.broken=4}';
const folder = freshFolder();
let browser;
before(async () => (browser = await openBrowser()));
after(() => browser.close());

// Names and digits that the program refuses in any other form.
const CHECKED = /^(sipailou|paper-2024|[0-9a-f]{16})$/;

/** Every string of a JSON value replaced. */
function poisoned(value) {
  if (typeof value === 'string') return CHECKED.test(value) ? value : EVIL;
  if (Array.isArray(value)) return value.map(poisoned);
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, poisoned(inner)]));
}

test('strings of result.json stay text wherever they are shown', async () => {
  const [run] = simulatedRuns(folder);
  const hostile = join(folder, `<img src=x onerror=globalThis.broken=5>`);
  mkdirSync(hostile);
  const result = poisoned(JSON.parse(readFileSync(join(run, '06/result.json'), 'utf8')));
  result.settings['<b onclick=1>'] = EVIL;
  // The program refuses a name that leads through folders.
  result.sequence = EVIL.replaceAll('/', '');
  writeFileSync(join(hostile, 'result.json'), JSON.stringify(result));
  const file = join(folder, 'hostile.html');
  mosbench('report', hostile, '-o', file, '--scans', 'none');
  const page = await openReport(browser, file);
  await page.waitForSelector('.provenance td');
  assert.equal(await page.evaluate(() => globalThis.broken), undefined);
  assert.equal(await page.locator('img, b, svg').count(), 0);
  assert.ok((await page.locator('.provenance').textContent()).includes(EVIL), 'it is shown as it is');
  refuseComplaints(page);
});

test('a script that got into the file all the same is not run', async () => {
  const [run] = [join(folder, 'online')];
  const file = join(folder, 'injected.html');
  mosbench('report', run, '-o', file, '--scans', 'none');
  const injected = readFileSync(file, 'utf8').replace('<noscript>', '<script>globalThis.broken = 6</script><noscript>');
  writeFileSync(file, injected);
  const page = await openReport(browser, file);
  await page.waitForSelector('.provenance td');
  assert.equal(await page.evaluate(() => globalThis.broken), undefined);
  assert.ok(page.complaints.some((complaint) => complaint.includes('Content Security Policy')));
});

test('a report opens from any folder it is copied to', async () => {
  const elsewhere = join(folder, 'a b # ü');
  mkdirSync(elsewhere);
  copyFileSync(join(folder, 'hostile.html'), join(elsewhere, 'r?.html'));
  const page = await openReport(browser, join(elsewhere, 'r?.html'));
  await page.waitForSelector('.provenance td');
  refuseComplaints(page);
});
