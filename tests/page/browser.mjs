// Opens reports as a reader would: from file://, in Chromium, with every request to a network refused.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const require = createRequire(new URL('../../eval/report/page/package.json', import.meta.url));
const { chromium } = require('playwright-core');

const ARGUMENTS = [
  '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader', '--force-color-profile=srgb', '--font-render-hinting=none',
];

export const DESKTOP = { width: 1280, height: 900 };
export const PHONE = { width: 390, height: 844 };

export function openBrowser() {
  return chromium.launch({
    executablePath: process.env.MOSBENCH_CHROMIUM ?? '/usr/bin/chromium',
    args: ARGUMENTS,
  });
}

/**
 * A page on `file` with all its parts. `complaints` fills with whatever went wrong; `before` runs in it ahead of all else.
 */
export async function openReport(browser, file, { viewport = DESKTOP, theme = 'light', before = null } = {}) {
  const context = await browser.newContext({ viewport, colorScheme: theme, offline: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.complaints = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
  });
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('request', (request) => {
    if (!/^(file|data|blob):/.test(request.url())) page.complaints.push(`asks for ${request.url()}`);
  });
  if (before) await page.addInitScript(before);
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(() => globalThis.mosbenchReport);
  return page;
}

export function refuseComplaints(page) {
  assert.deepEqual(page.complaints, []);
}

/** Waits until the panes show what the state says. */
export async function settled(page) {
  await page.waitForFunction(() => {
    const { state, viewer } = globalThis.mosbenchReport;
    const what = state.get('view') === 'map' ? 'map' : state.get('scan');
    return viewer.node.dataset.shown === `${what} ${viewer.results().join(' ')}`;
  });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}
