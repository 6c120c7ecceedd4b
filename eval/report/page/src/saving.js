import { element } from './dom.js';

/** Hands a file to the reader, as if it had been downloaded. */
export function save(blob, name) {
  const url = URL.createObjectURL(blob);
  element('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60000);
}

/** A name that every file system takes. */
export function fileName(parts, extension) {
  return `${parts.join('_').replaceAll(/[^\w.-]+/g, '-')}.${extension}`;
}

/** A button that saves a drawing: `draw` makes the svg element. */
export function svgButton(name, draw) {
  const call = () => save(new Blob([new XMLSerializer().serializeToString(draw())], { type: 'image/svg+xml' }), fileName([name], 'svg'));
  return element('button', { type: 'button', class: 'save', title: 'Save as a vector drawing', onclick: call }, 'SVG');
}
