// mosbench truth review as a person uses it: by keys, on a phone, over a kill of the server.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { DESKTOP, PHONE, openBrowser, refuseComplaints } from './browser.mjs';
import { freshFolder, mosbench } from './reports.mjs';

const folder = freshFolder();
const truth = join(folder, 'truth');
let browser;

before(async () => {
  mosbench('simulate', '--layout', 'semantickitti', '--scene', 'street', '--scans', '40', '--seed', '1', '--out', join(folder, 'street'));
  mosbench('truth', 'propose', join(folder, 'street'), '-o', truth);
  browser = await openBrowser();
});
after(() => browser.close());

/** The server, once it told its address; `kill` ends it as a power cut would. */
async function serve(t) {
  const server = spawn(process.env.MOSBENCH_PROGRAM, ['truth', 'review', truth]);
  t.after(() => server.kill('SIGKILL'));
  let told = '';
  for await (const part of server.stderr) {
    told += part;
    const address = /open (http:\S+) in/.exec(told);
    if (!address) continue;
    return { address: address[1], kill: async () => { server.kill('SIGKILL'); await once(server, 'close'); } };
  }
  throw new Error(told);
}

async function open(address, viewport = DESKTOP) {
  const page = await (await browser.newContext({ viewport })).newPage();
  page.complaints = [];
  page.on('console', (message) => { if (message.type() === 'error') page.complaints.push(message.text()); });
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith('http://127.0.0.1:')) page.complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(address);
  await page.waitForFunction(() => film !== null);
  return page;
}

const stored = () => JSON.parse(readFileSync(join(truth, 'decisions.json'))).decisions;
const shown = (page) => page.evaluate(() => tracks[shown]);
/** Presses a key and waits until the page has done what it asks for. */
async function press(page, key) {
  await page.keyboard.press(key);
  await page.evaluate(() => busy);
}
/** The key that says of the shown track what the program guesses. */
const agreeing = async (page) => ((await shown(page)).guess === 'moving' ? 'm' : 's');

test('decisions by keys alone are stored at once, and survive a kill of the server', async (t) => {
  const first = await serve(t);
  const page = await open(first.address);
  assert.match(await page.textContent('#left'), /decisions? left, about/);
  const coloured = await page.evaluate(() => {
    draw();
    const canvas = document.querySelector('canvas');
    return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((value, i) => i % 4 === 0 && value > 200);
  });
  assert.ok(coloured, 'the track is drawn');
  const one = await shown(page);
  await press(page, await agreeing(page));
  assert.deepEqual(stored(), [{ track: one.id, decided: one.guess }]);
  const two = await shown(page);
  assert.notEqual(two.id, one.id, 'the next track is shown');
  await press(page, 'u');
  await press(page, 'z');
  assert.equal((await shown(page)).id, two.id);
  assert.equal(stored().at(-1).decided, 'taken-back');
  refuseComplaints(page);
  await first.kill();
  await press(page, 'u');
  assert.match(await page.textContent('#fault'), /fetch/i, 'what was not stored is told');
  assert.equal(stored().length, 3);
  const second = await serve(t);
  const again = await open(second.address, PHONE);
  assert.equal((await shown(again)).id, two.id);
  await again.click('button[data-key=u]');
  await again.evaluate(() => busy);
  assert.deepEqual(stored().at(-1), { track: two.id, decided: 'unsure' });
  refuseComplaints(again);
  await second.kill();
});

test('a decision against nearly all looks wants its key twice', async (t) => {
  const server = await serve(t);
  const page = await open(server.address);
  const sure = await page.evaluate(() => tracks.findIndex((track) => track.doubt < 0.2));
  assert.ok(sure >= 0, 'the scene has a sure track');
  await page.evaluate((index) => show(index), sure);
  const track = await shown(page);
  const key = track.guess === 'moving' ? 's' : 'm';
  const count = stored().length;
  await press(page, key);
  assert.match(await page.textContent('#fault'), /of the looks from other scans say/);
  assert.equal(stored().length, count);
  await press(page, key);
  assert.equal(stored().at(-1).track, track.id);
  assert.equal(stored().length, count + 1);
  refuseComplaints(page);
  await server.kill();
});
