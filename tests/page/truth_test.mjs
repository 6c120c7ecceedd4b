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

async function open(t, address, viewport = DESKTOP) {
  const page = await (await browser.newContext({ viewport })).newPage();
  t.after(() => page.close());
  page.complaints = [];
  page.on('console', (message) => { if (message.type() === 'error') page.complaints.push(message.text()); });
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith('http://127.0.0.1:')) page.complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(address);
  await page.waitForFunction(() => globalThis.mosbenchReview?.film.data);
  return page;
}

const stored = () => JSON.parse(readFileSync(join(truth, 'decisions.json'))).decisions;
const shown = (page) => page.evaluate(() => mosbenchReview.shown());
/** Presses a key and waits until the page has done what it asks for. */
async function press(page, key) {
  await page.keyboard.press(key);
  await page.evaluate(() => mosbenchReview.busy());
}
/** The key that says of the shown track what the program guesses. */
const agreeing = async (page) => ((await shown(page)).guess === 'moving' ? 'm' : 's');

test('decisions by keys alone are stored at once, and survive a kill of the server', async (t) => {
  const first = await serve(t);
  const page = await open(t, first.address);
  assert.match(await page.textContent('#left'), /decisions? left, about/);
  const coloured = await page.evaluate(() => {
    mosbenchReview.redraw();
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
  const again = await open(t, second.address, PHONE);
  assert.equal((await shown(again)).id, two.id);
  await again.click('button[data-key=u]');
  await again.evaluate(() => mosbenchReview.busy());
  assert.deepEqual(stored().at(-1), { track: two.id, decided: 'unsure' });
  refuseComplaints(again);
  await second.kill();
});

test('a decision against nearly all looks wants its key twice', async (t) => {
  const server = await serve(t);
  const page = await open(t, server.address);
  const sure = await page.evaluate(() => mosbenchReview.tracks().find((track) => track.doubt < 0.2)?.id);
  assert.ok(sure, 'the scene has a sure track');
  await page.evaluate((id) => mosbenchReview.show(id), sure);
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

/** The longest track, so that there are scans to cut it at. */
async function showLongest(page) {
  await page.evaluate(() => {
    const length = ({ scans }) => scans[1] - scans[0];
    return mosbenchReview.show(mosbenchReview.tracks().toSorted((a, b) => length(b) - length(a))[0].id);
  });
  return shown(page);
}

test('a cut, a split and a merge by keys alone, each taken back', async (t) => {
  const server = await serve(t);
  const page = await open(t, server.address);
  const whole = await showLongest(page);
  await press(page, 'Space');
  await page.evaluate(() => { mosbenchReview.film.frame = 0; });
  await press(page, 'c');
  assert.match(await page.textContent('#fault'), /a cut needs a later scan/);
  for (let i = 0; i < 15; i += 1) await press(page, '.');
  await press(page, 'c');
  const later = await shown(page);
  assert.equal(stored().at(-1).track, later.id);
  assert.equal(stored().at(-1).takes[whole.number], later.points);
  assert.ok(later.points > 0 && later.points < whole.points);
  assert.equal(await page.evaluate(({ id, points }) => mosbenchReview.tracks().find((track) => track.id === id).points + points, { id: whole.id, points: later.points }), whole.points);
  await press(page, 'z');
  assert.deepEqual(await shown(page), whole);
  assert.equal(stored().at(-1).decided, 'unmade');

  // A polygon around the left half of the picture, over all scans: the cursor begins in the middle of the way.
  await page.fill('#scans', '99');
  await page.locator('#scans').blur();
  await press(page, 'x');
  assert.match(await page.textContent('#hint'), /polygon/);
  await press(page, 'x');
  assert.match(await page.textContent('#fault'), /three corners/);
  const corner = async (key, times) => {
    for (let i = 0; i < times; i += 1) await page.keyboard.press(`Shift+${key}`);
    await press(page, 'Enter');
  };
  await corner('ArrowUp', 8);
  await corner('ArrowLeft', 8);
  await corner('ArrowDown', 16);
  await press(page, 'Backspace');
  assert.equal(await page.evaluate(() => mosbenchReview.drawing().corners.length), 2);
  await press(page, 'Enter');
  await corner('ArrowRight', 8);
  await press(page, 'x');
  assert.equal(await page.textContent('#fault'), '');
  const left = await shown(page);
  assert.equal(stored().at(-1).takes[whole.number], left.points);
  assert.ok(left.points > 0 && left.points < whole.points);
  await press(page, 'z');
  assert.deepEqual(await shown(page), whole);
  await press(page, 'p');
  await press(page, 'Escape');
  assert.equal(await page.evaluate(() => mosbenchReview.drawing()), null);
  refuseComplaints(page);
  await server.kill();
});

test('on a phone, a polygon of taps paints what no track holds, and a tap merges', async (t) => {
  const server = await serve(t);
  const page = await open(t, server.address, PHONE);
  const first = await showLongest(page);
  const tap = async (x, y) => {
    const box = await page.locator('#film').boundingBox();
    await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    await page.evaluate(() => mosbenchReview.busy());
  };
  const tapButton = async (key) => {
    await page.click(`button[data-key="${key}"]`);
    await page.evaluate(() => mosbenchReview.busy());
  };
  await page.fill('#scans', '3');
  await tapButton('p');
  for (const [x, y] of [[0.01, 0.01], [0.99, 0.01], [0.99, 0.99], [0.01, 0.99]]) await tap(x, y);
  await tapButton('p');
  assert.equal(await page.textContent('#fault'), '');
  const painted = await shown(page);
  const entry = stored().at(-1);
  assert.equal(entry.takes[0], painted.points);
  assert.equal(entry.scans[1] - entry.scans[0], 2);
  const sides = entry.corners_m.map(([x, y], i) => Math.hypot(x - entry.corners_m[(i + 1) % 4][0], y - entry.corners_m[(i + 1) % 4][1]));
  for (const side of sides) assert.ok(Math.abs(side - sides[0]) < 0.05 * sides[0], 'the square that was tapped');
  await tapButton('m');
  assert.deepEqual(stored().at(-1), { track: painted.id, decided: 'moving' });

  await page.evaluate((id) => mosbenchReview.show(id), first.id);
  const place = await page.evaluate((number) => {
    const { film } = mosbenchReview;
    film.playing = false;
    film.frame = film.data.frames.findIndex(({ others }) => others[number]);
    const [x, y] = film.now().others[number];
    return [0.5 + x / film.data.half_cm / 2, 0.5 - y / film.data.half_cm / 2];
  }, painted.number);
  await tapButton('g');
  await tap(...place);
  assert.equal(await page.textContent('#fault'), '');
  const merged = await shown(page);
  assert.deepEqual(stored().at(-1).takes, { [first.number]: first.points, [painted.number]: painted.points });
  assert.equal(merged.points, first.points + painted.points);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), true, 'nothing is cut off');
  refuseComplaints(page);
  await server.kill();
});
