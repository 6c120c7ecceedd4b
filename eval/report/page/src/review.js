import { element } from './dom.js';
import { Drawing } from './review_drawing.js';
import { Film } from './review_film.js';
import { Space } from './review_space.js';
import { preferredTheme } from './theme.js';

const DECIDES = { m: 'moving', s: 'static', u: 'unsure' };
const DRAWS = { x: 'split', p: 'paint', g: 'merge' };
const HINTS = {
  split: 'Set the corners of a polygon around what leaves this track (tap, or arrows and Enter), then X again.',
  paint: 'Set the corners of a polygon around what is in no track (tap, or arrows and Enter), then P again.',
  merge: 'Tap the track that this one belongs to, or arrows and Enter.',
};
const TO_THE_END = 4294967295;
const BUTTONS = [
  ['m', 'Moving (M)'], ['s', 'Static (S)'], ['u', 'Unsure (U)'], ['z', 'Undo (Z)'],
  ['b', 'Back (←)'], ['l', 'Later (→)'], [' ', 'Play (space)'], [',', 'Scan − (,)'], ['.', 'Scan + (.)'],
  ['c', 'Cut here (C)'], ['x', 'Split (X)'], ['g', 'Merge (G)'], ['p', 'Paint (P)'],
  ['-', 'Wider (−)'], ['+', 'Closer (+)'], ['q', 'Turn (Q)'], ['Escape', 'Give up (Esc)'],
];
const token = new URL(location.href).searchParams.get('token');
const byId = (id) => document.getElementById(id);

let tracks = [], shown = null, wider = 1, asked = '', drawing = null;
const done = []; // what undo takes back, the last one first

function layOut() {
  document.documentElement.dataset.theme = preferredTheme();
  document.head.append(element('link', { rel: 'icon', href: 'data:,' })); // the server has none
  const buttons = BUTTONS.map(([key, name]) => element('button', { type: 'button', 'data-key': key }, name));
  document.body.append(element('main', { class: 'review' },
    element('p', { id: 'left', 'aria-live': 'polite' }),
    element('div', { class: 'views' },
      element('canvas', { id: 'film', width: 900, height: 900, role: 'img', 'aria-label': 'The track from above' }),
      element('canvas', { id: 'space', role: 'img', 'aria-label': 'The track in 3-D' })),
    element('p', { id: 'track' }),
    element('div', { class: 'keys' }, ...buttons),
    element('label', { class: 'hint' }, 'Split and paint over ', element('input', { id: 'scans', type: 'number', min: 1, max: 9999, value: 1 }), ' scans from the shown one'),
    element('p', { id: 'hint', class: 'hint', 'aria-live': 'polite' }),
    element('p', { id: 'fault', role: 'alert' })));
}
layOut();
const film = new Film(byId('film'));
const space = new Space(byId('space'), preferredTheme());

async function ask(path, values = {}) {
  const response = await fetch(path, { method: 'POST', body: JSON.stringify({ ...values, token }) });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response.json();
}

const shownTrack = () => tracks.find((track) => track.id === shown);

function take(state) {
  tracks = state.tracks;
  byId('left').textContent = state.left;
  const track = shownTrack();
  byId('track').textContent = track
    ? `Track ${track.id}: ${track.points} points, scans ${track.scans[0]} to ${track.scans[1]}; guess ${track.guess}; ${track.decided ? `decided ${track.decided}` : 'undecided'}`
    : 'There is no such track.';
}

/** Shows a track; the same one again goes on at the same scan. */
async function show(id) {
  if (!id) return;
  if (id !== shown) wider = 1;
  const scan = id === shown ? film.now()?.scan : null;
  const data = await ask('film', { track: id, wider });
  drawing = null;
  shown = id;
  film.load(data, scan);
  space.turn(0, data.half_cm);
  take(await ask('tracks'));
}

const go = (by) => show(tracks[tracks.findIndex((track) => track.id === shown) + by]?.id);
const nextUndecided = () => tracks.find((track) => !track.decided)?.id;

async function decide(track, decided) {
  take(await ask('decide', { track, decided }));
}

async function undo() {
  const last = done.at(-1);
  if (!last) return;
  await decide(last.id, last.from ? 'unmade' : last.before ?? 'taken-back');
  done.pop();
  await show(last.from ?? last.id);
}

async function decideShown(key) {
  const { id, decided, guess, doubt } = shownTrack();
  const isAgainst = key !== 'u' && DECIDES[key] !== guess && doubt < 0.2;
  if (isAgainst && asked !== id + key) {
    asked = id + key;
    throw new Error(`${Math.round(100 * (1 - doubt))} % of the looks from other scans say ${guess}: press ${key.toUpperCase()} again if they are wrong`);
  }
  await decide(id, DECIDES[key]);
  done.push({ id, before: decided });
  await show(nextUndecided());
}

/** Makes a track of points of the tracks with these numbers, 0 for points of no track. */
async function make(numbers, scans, corners = []) {
  const { sequence, id } = shownTrack();
  const takes = Object.fromEntries(numbers.map((number) => [number, 0]));
  const { made } = await ask('make', { sequence, takes, scans, corners_m: corners.map((corner) => film.metres(corner)) });
  done.push({ id: made, from: id });
  await show(made);
}

function cut() {
  const { number, scans } = shownTrack();
  const { scan } = film.now();
  if (scan <= scans[0]) throw new Error('a cut needs a later scan: pause with the space bar, then go on with the full stop');
  return make([number], [scan, TO_THE_END]);
}

function finish({ kind, corners }) {
  const { number } = shownTrack();
  const { scan } = film.now();
  if (kind === 'merge') {
    const other = film.otherAt(corners.pop());
    if (!other) throw new Error('there is no other track at this place');
    return make([number, other], [0, TO_THE_END]);
  }
  if (corners.length < 3) throw new Error('a polygon needs three corners');
  const scans = Math.max(1, Number(byId('scans').value) || 1);
  return make([kind === 'paint' ? 0 : number], [scan, scan + scans - 1], corners);
}

function draw(kind) {
  if (drawing?.kind === kind) return finish(drawing);
  drawing = new Drawing(kind, film.data.half_cm, finish);
  return null;
}

function widen(by) {
  wider = Math.max(1, Math.min(16, wider * by));
  return show(shown);
}

const ACTIONS = {
  z: undo, b: () => go(-1), l: () => go(1), c: cut,
  ' ': () => { film.playing = !film.playing; },
  ',': () => { film.playing = false; film.step(-1); },
  '.': () => { film.playing = false; film.step(1); },
  '-': () => widen(2), '+': () => widen(0.5),
  q: () => space.turn(0.3, film.data.half_cm),
  Escape: () => { drawing = null; },
  ...Object.fromEntries(Object.keys(DECIDES).map((key) => [key, () => decideShown(key)])),
  ...Object.fromEntries(Object.entries(DRAWS).map(([key, kind]) => [key, () => draw(kind)])),
};

let busy = Promise.resolve();
function enqueue(work) {
  const answer = (text) => { byId('fault').textContent = text; redraw(); };
  busy = busy.then(work).then(() => answer(''), (error) => answer(error.message));
  return busy;
}

function redraw() {
  film.draw(drawing);
  space.show(film.now());
  byId('hint').textContent = HINTS[drawing?.kind] ?? '';
  document.querySelector('[data-key=Escape]').hidden = !drawing;
}

document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest('input')) return;
  const { key, shiftKey } = event;
  const arrow = { ArrowLeft: 'b', ArrowRight: 'l' }[key];
  const action = drawing?.takes(key) ? () => drawing?.press(key, shiftKey) : ACTIONS[arrow ?? (key.length === 1 ? key.toLowerCase() : key)];
  if (!action || (event.target.closest('button') && [' ', 'Enter'].includes(key))) return;
  event.preventDefault();
  enqueue(() => (shown ? action() : null));
});
for (const button of document.querySelectorAll('button')) {
  button.addEventListener('click', () => {
    button.blur(); // or the space bar would press it again
    enqueue(() => (shown ? ACTIONS[button.dataset.key]() : null));
  });
}
film.canvas.addEventListener('pointerdown', (event) => {
  const place = drawing && film.placeOf(event);
  if (place) enqueue(() => drawing?.add(place));
});
setInterval(() => {
  if (document.hidden) return;
  if (film.playing && !drawing) film.step(1);
  redraw();
}, 200);
// Another page may decide, too.
setInterval(() => ask('tracks').then(take, () => {}), 3000);
enqueue(async () => {
  take(await ask('tracks'));
  await show(nextUndecided() ?? tracks[0]?.id);
});
globalThis.mosbenchReview = { film, show, redraw, tracks: () => tracks, shown: shownTrack, busy: () => busy, drawing: () => drawing };
