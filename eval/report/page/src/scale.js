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

  /** `scale`: {low, high}, or null for none; `thresholds` of the shown scans, for dynamic scores. */
  fill(key, scale, theme, thresholds) {
    this.node.hidden = scale === null;
    if (!scale) return;
    const { name, unit, digits } = COLOURINGS.find((colouring) => colouring.key === key);
    const stops = Array.from({ length: 10 }, (_, i) => `rgb(${scaleColour(i / 9, theme).join(',')})`);
    const bar = element('span', { class: 'bar' });
    bar.style.background = `linear-gradient(to right, ${stops.join(',')})`;
    const ofScore = key === 'score';
    this.node.replaceChildren(
      element('span', {}, name),
      ...(ofScore ? [swatch(colourWithoutScore(theme)), element('span', {}, 'none')] : []),
      element('span', {}, fixed(scale.low, digits)), bar, element('span', {}, fixed(scale.high, digits, unit)),
      ...(ofScore && thresholds.length > 0 ? [element('span', { class: 'faint' }, `threshold ${thresholds.map((t) => fixed(t, 0)).join(' · ')}`)] : []),
    );
  }
}
