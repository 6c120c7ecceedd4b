// The site of the manual, as a reader uses it: first page, search, links, results; and nothing from other servers.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, extname, join, normalize } from 'node:path';
import { after, before, test } from 'node:test';
import { openBrowser } from './browser.mjs';

const source = process.env.MOSBENCH_SOURCE_DIR;
const site = join(source, 'build/site');
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.png': 'image/png' };
const has = spawnSync('mkdocs', ['--version']).status === 0;
const skip = has ? false : 'there is no mkdocs (scripts/setup.sh --page installs it)';
let browser;
let server;
let home;

before(async () => {
  if (!has) return;
  execFileSync(join(source, 'scripts/docs/build_site.sh'), [process.env.MOSBENCH_PROGRAM], { stdio: ['ignore', 'ignore', 'pipe'] });
  server = createServer((request, response) => {
    const path = join(site, normalize(decodeURIComponent(new URL(request.url, 'http://a').pathname)));
    try {
      const body = readFileSync(path);
      response.writeHead(200, { 'content-type': TYPES[extname(path)] ?? 'application/octet-stream' }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
  home = `http://127.0.0.1:${server.address().port}`;
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  server?.close();
});

/** A page at `path` that fills `complaints` with requests to other servers, or in vain, and with errors of scripts. */
async function open(path, colorScheme = 'light') {
  const page = await (await browser.newContext({ colorScheme })).newPage();
  page.complaints = [];
  page.on('request', (request) => {
    if (!request.url().startsWith(home) && !/^(data|blob):/.test(request.url())) page.complaints.push(request.url());
  });
  page.on('response', (answer) => answer.status() >= 400 && page.complaints.push(`${answer.status()} ${answer.url()}`));
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  await page.goto(`${home}/${path}`);
  return page;
}

test('search finds a setting, and its link leads there', { skip }, async () => {
  const page = await open('index.html');
  assert.match(await page.locator('h1').first().innerText(), /^mosbench/);
  await page.locator('.md-search__input').click();
  await page.keyboard.type('otsu_min');
  const hit = page.locator('.md-search-result__link[href*="reference/settings.html"]').first();
  await hit.waitFor();
  await hit.click();
  await page.waitForURL('**/docs/reference/settings.html*');
  assert.match(await page.locator('article').innerText(), /min_otsu_score/);
  assert.deepEqual(page.complaints, []);
});

test('a reader who likes it dark gets it dark', { skip }, async () => {
  for (const [liked, scheme] of [['light', 'default'], ['dark', 'slate']]) {
    const page = await open('index.html', liked);
    assert.equal(await page.locator('body').getAttribute('data-md-color-scheme'), scheme);
  }
});

test('results show the table and the scans', { skip }, async () => {
  const page = await open('results/index.html');
  assert.match(await page.locator('article table').first().innerText(), /HMM-MOS plus/);
  const report = page.frames().find((frame) => frame.url().endsWith('street.html'));
  await report.waitForFunction(() => globalThis.mosbenchReport);
  assert.deepEqual(page.complaints, []);
});

test('every link with a # leads to a place of its page', { skip }, () => {
  const pages = new Map(readdirSync(site, { recursive: true }).filter((name) => name.endsWith('.html') && !name.endsWith('street.html'))
    .map((name) => [name, readFileSync(join(site, name), 'utf8')]));
  let followed = 0;
  for (const [name, text] of pages) {
    for (const [, path, place] of text.matchAll(/href="([^":]*)#([^"]+)"/g)) {
      const target = path ? normalize(join(dirname(name), path)) : name;
      if (!pages.has(target)) continue;
      followed += 1;
      assert.ok(pages.get(target).includes(`id="${decodeURIComponent(place)}"`), `${name}: ${path}#${place}`);
    }
  }
  assert.ok(followed > 100);
});

test('a dead link is an error', { skip }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'site-'));
  mkdirSync(join(folder, 'pages'));
  writeFileSync(join(folder, 'mkdocs.yml'), `INHERIT: ${source}/scripts/docs/mkdocs.yml\ndocs_dir: pages\nsite_dir: out\nnav: null\n`);
  const build = (link) => {
    writeFileSync(join(folder, 'pages/index.md'), `# A\n[link](${link})\n`);
    return spawnSync('mkdocs', ['build', '--strict', '-f', join(folder, 'mkdocs.yml')], { encoding: 'utf8' });
  };
  assert.equal(build('index.md').status, 0);
  const { status, stderr } = build('gone.md');
  assert.notEqual(status, 0);
  assert.match(stderr, /gone\.md/);
});
