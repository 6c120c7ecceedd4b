import { element } from './dom.js';

/** A labelled drop-down of `options`: [{key, name, disabled}]; `change` gets the chosen key as text. */
export function choice(label, options, selected, change) {
  const select = element('select', { 'aria-label': label, onchange: () => change(select.value) });
  select.append(...options.map(({ key, name, disabled }) => element('option', { value: key, selected: key === selected, disabled }, name)));
  return element('label', { class: 'choice' }, label, select);
}
