// node tests/page/load_times.mjs REPORT.html [RUNS]: milliseconds from opening a report until its charts
// and its first scan are drawn, per run and as median. The browser runs already, as a reader's does: a
// first opening that starts its processes is not counted. No test: times depend on the machine.
import { openBrowser, openReport, refuseComplaints } from './browser.mjs';

const [file, runs = '5'] = process.argv.slice(2);

/** Notes when what was drawn has come to the screen. */
function watch() {
  globalThis.drawn_ms = {};
  const isDrawn = {
    charts: () => document.querySelector('.chart canvas'),
    scan: () => document.querySelector('.stage')?.dataset.shown,
  };
  const look = () => {
    for (const [what, test] of Object.entries(isDrawn)) {
      if (!(what in globalThis.drawn_ms) && test()) requestAnimationFrame(() => (globalThis.drawn_ms[what] ??= performance.now()));
    }
    requestAnimationFrame(look);
  };
  look();
}

const browser = await openBrowser();

async function once() {
  const page = await openReport(browser, file, { before: watch });
  await page.waitForFunction(() => 'charts' in globalThis.drawn_ms && 'scan' in globalThis.drawn_ms);
  const { charts, scan } = await page.evaluate(() => globalThis.drawn_ms);
  refuseComplaints(page);
  await page.context().close();
  return { charts, scan };
}

await once();
const times = [];
for (let i = 0; i < Number(runs); ++i) {
  times.push(await once());
  console.log(`charts ${times[i].charts.toFixed(0)} ms, first scan ${times[i].scan.toFixed(0)} ms`);
}
await browser.close();
const median = (key) => times.map((t) => t[key]).sort((a, b) => a - b)[Math.floor(times.length / 2)];
console.log(`median: charts ${median('charts').toFixed(0)} ms, first scan ${median('scan').toFixed(0)} ms`);
