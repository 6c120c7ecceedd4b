import { element } from './dom.js';

/** Runs beside the chosen one, at most. */
export const MOST_BESIDE = 5;

/** The names of results, numbered where they are the same. */
export function runNames(entries) {
  const names = entries.map(({ run }) => run);
  const count = (name, until) => names.slice(0, until).filter((other) => other === name).length;
  return names.map((name, i) => (count(name) > 1 ? `${name} (${count(name, i + 1)})` : name));
}

/** What a menu offers beside a result: [{key, name}], told apart from it, too. */
export function runOptions({ results }, chosen, others) {
  const names = runNames([chosen, ...others].map((i) => results[i]));
  return others.map((key, i) => ({ key, name: names[i + 1] }));
}

/** `chosen` with a key more or, where it is there, less. */
export function toggled(chosen, key) {
  return chosen.includes(key) ? chosen.filter((other) => other !== key) : [...chosen, key];
}

/** A drop-down of boxes to tick; `change` gets the keys of those that are ticked, in that order. */
export class RunsMenu {
  constructor(label, change) {
    Object.assign(this, { label, change, boxes: [], keys: null });
    this.summary = element('summary', {});
    this.list = element('div', { class: 'menu-list', role: 'group', 'aria-label': label });
    this.node = element('details', { class: 'menu' }, this.summary, this.list);
    document.addEventListener('pointerdown', ({ target }) => this.node.contains(target) || (this.node.open = false));
    this.node.addEventListener('keydown', ({ key }) => key === 'Escape' && (this.node.open = false));
  }

  /** `options`: [{key, name}]; without any it is not shown. The boxes stay the same, so that they keep the focus. */
  fill(options, chosen) {
    this.node.hidden = options.length === 0;
    this.chosen = chosen;
    const keys = options.map(({ key, name }) => `${key} ${name}`).join();
    if (keys !== this.keys) this.#make(options);
    this.keys = keys;
    for (const { key, box } of this.boxes) {
      box.checked = chosen.includes(key);
      box.disabled = !box.checked && chosen.length >= MOST_BESIDE;
    }
    const names = options.filter(({ key }) => chosen.includes(key)).map(({ name }) => name);
    this.summary.replaceChildren(element('span', { class: 'faint' }, this.label), ` ${names.length > 1 ? `${names.length} runs` : (names[0] ?? 'nothing')}`);
  }

  #make(options) {
    this.boxes = options.map(({ key, name }) => {
      const box = element('input', { type: 'checkbox', onchange: () => this.change(toggled(this.chosen, key)) });
      return { key, name, box };
    });
    this.list.replaceChildren(...this.boxes.map(({ name, box }) => element('label', {}, box, name)));
  }
}
