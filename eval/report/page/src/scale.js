import { COLOURINGS, colourWithoutScore } from './colouring.js';
import { element } from './dom.js';
import { fixed } from './format.js';
import { scaleColour } from './theme.js';

function swatch(colour) {
  const spot = element('span', { class: 'swatch' });
  spot.style.background = colour;
  return spot;
}

/** The key to colours that stand for a quantity. */
export class Scale {
  node = element('div', { class: 'scale', hidden: true });

  /**
   * `scale`: {low, high, digits}, or null for none; `name` of the quantity; of a score also its thresholds in the
   * shown scans, [{name, threshold}].
   */
  fill(key, scale, theme, { name, thresholds }) {
    this.node.hidden = scale === null;
    this.node.classList.remove('kinds');
    if (!scale) return;
    const { unit, digits = scale.digits } = COLOURINGS.find((colouring) => colouring.key === key);
    const stops = Array.from({ length: 10 }, (_, i) => `rgb(${scaleColour(i / 9, theme).join(',')})`);
    const bar = element('span', { class: 'bar' });
    bar.style.background = `linear-gradient(to right, ${stops.join(',')})`;
    const ofScore = key === 'score';
    this.node.replaceChildren(
      element('span', {}, name),
      ...(ofScore ? [swatch(colourWithoutScore(theme)), element('span', {}, 'none')] : []),
      element('span', {}, fixed(scale.low, digits)), bar, element('span', {}, fixed(scale.high, digits, unit)),
      ...(ofScore && thresholds.length > 0 ? [element('span', { class: 'faint' }, [...new Set(thresholds.map((t) => `${t.name} ${fixed(t.threshold, digits)}`))].join(' · '))] : []),
    );
  }

  /** The key to colours that stand for kinds: [{name, colour}]. */
  fillKinds(kinds) {
    this.node.hidden = false;
    this.node.classList.add('kinds');
    this.node.replaceChildren(...kinds.map(({ name, colour }) => element('span', { class: 'kind' }, swatch(colour), name)));
  }
}
