/** A link to what is looked at: the page's address with result, scan, view and camera behind the #. */

import { COLOURINGS } from './colouring.js';
import { VIEWS } from './views.js';

const FAR_M = 1e5;

const rounded = (numbers) => numbers.map((n) => Number(n.toFixed(2))).join(',');

/** "#result=0&beside=1&scan=21&view=orbit&colour=outcome&eye=-22,-13,17&target=4,0,-1" */
export function hashOf(state, { eye, target }) {
  const others = state.get('others');
  return `#${[
    `result=${state.get('result')}`, ...(others.length > 0 ? [`beside=${others.join(',')}`] : []), `scan=${state.get('scan')}`,
    `view=${state.get('view')}`, ...(state.get('boxes') ? ['boxes=1'] : []), `colour=${state.get('colouring')}`, `eye=${rounded(eye)}`, `target=${rounded(target)}`,
  ].join('&')}`;
}

function whole(text, below) {
  return /^\d{1,9}$/.test(text ?? '') && Number(text) < below ? Number(text) : null;
}

function place(text) {
  const numbers = (text ?? '').split(',').map(Number);
  return text && numbers.length === 3 && numbers.every((n) => Math.abs(n) < FAR_M) ? numbers : null;
}

const keyOf = (list, key) => (list.some((item) => item.key === key) ? key : null);

/**
 * {changes, camera} of a hash: values for the state, and {eye, target} or null. Anybody may have written it: what is
 * not of this report is left out. `comparable` gives the results of the same scans.
 */
export function viewOf(hash, content, comparable) {
  const words = new Map(hash.slice(1).split('&').map((word) => word.split('=')));
  const result = whole(words.get('result'), content.results.length);
  if (result === null) return { changes: {}, camera: null };
  const found = {
    scan: whole(words.get('scan'), content.results[result].result.scans.length),
    view: keyOf(VIEWS, words.get('view')),
    colouring: keyOf(COLOURINGS, words.get('colour')),
    boxes: words.get('boxes') === '1' ? true : null,
  };
  const beside = (words.get('beside') ?? '').split(',').map((text) => whole(text, content.results.length));
  const others = comparable(result).filter((other) => beside.includes(other));
  const [eye, target] = [place(words.get('eye')), place(words.get('target'))];
  const known = Object.entries(found).filter(([, value]) => value !== null);
  return { changes: { result, others, ...Object.fromEntries(known) }, camera: eye && target ? { eye, target } : null };
}
