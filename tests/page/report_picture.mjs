// node tests/page/report_picture.mjs REPORT.html OUT.png [SCAN]: the first screen of a report, dark, as a
// picture for the README. scripts/docs/picture.sh makes both.
import { openBrowser, openReport, refuseComplaints, settled } from './browser.mjs';

const [file, out, scan = '0'] = process.argv.slice(2);
const browser = await openBrowser();
const page = await openReport(browser, file, { theme: 'dark', viewport: { width: 1280, height: 860 } });
await page.evaluate((k) => globalThis.mosbenchReport.state.set({ scan: k }), Number(scan));
await settled(page);
await page.screenshot({ path: out });
refuseComplaints(page);
await browser.close();
