/** What is being looked at. Parts of the page change it and follow it; none knows the others. */

export class State {
  #values;
  #followers = [];

  constructor(values) {
    this.#values = { ...values };
  }

  get(key) {
    return this.#values[key];
  }

  /** Changes some values at once and tells whoever follows one that really changed. */
  set(changes) {
    const changed = Object.keys(changes).filter((key) => this.#values[key] !== changes[key]);
    if (changed.length === 0) return;
    Object.assign(this.#values, changes);
    for (const { keys, call } of [...this.#followers]) {
      if (keys.some((key) => changed.includes(key))) call(this);
    }
  }

  /** Calls `call` now and whenever one of `keys` changes. */
  follow(keys, call) {
    this.#followers.push({ keys, call });
    call(this);
  }
}
