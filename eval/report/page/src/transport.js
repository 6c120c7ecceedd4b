import { element } from './dom.js';
import { hasCounts, worstScans } from './metrics.js';

const FRAME_MS = 200;

/** Play, step, slider and the way to the worst scans. */
export class Transport {
  node = element('div', { class: 'transport' });

  constructor(state, content, clouds) {
    Object.assign(this, { state, content, clouds });
    const button = (label, title, call) => element('button', { type: 'button', title, 'aria-label': title, onclick: call }, label);
    this.play = button('▶', 'Play (space)', () => this.toggle());
    this.slider = element('input', { type: 'range', min: 0, step: 1, 'aria-label': 'Scan', oninput: () => this.#slide() });
    this.label = element('output', { class: 'scan-label' });
    this.message = element('p', { class: 'hint', role: 'status' });
    this.node.append(
      element('div', { class: 'transport-row' },
        button('◀', 'Previous scan (left arrow)', () => this.step(-1)), this.play,
        button('▶|', 'Next scan (right arrow)', () => this.step(1)), this.slider, this.label,
        this.worst = button('worst', 'Next worse scan (w)', () => this.nextWorst())),
      this.message,
    );
    state.follow(['result', 'scan'], () => this.#show());
    state.follow(['result'], () => (this.worst.disabled = !this.#result().scans.some(hasCounts)));
  }

  #scans() {
    return this.clouds.scansOf(this.state.get('result'));
  }

  #result() {
    return this.content.results[this.state.get('result')].result;
  }

  #show() {
    const scans = this.#scans();
    const scan = this.state.get('scan');
    this.slider.max = Math.max(scans.length - 1, 0);
    this.slider.value = Math.max(scans.indexOf(scan), 0);
    const rows = this.#result().scans;
    this.label.textContent = `scan ${scan} of 0 to ${rows.length - 1} · ${rows[scan]?.stem ?? ''}`;
  }

  /** Goes to a scan, or to the nearest one whose points are in the file, and says so. */
  go(index) {
    if (index === undefined) return; // of a result without points
    const nearest = this.clouds.nearest(this.state.get('result'), index);
    this.message.textContent =
      nearest === null || nearest === index ? '' : `The points of scan ${index} were left out of this file; this is scan ${nearest}.`;
    this.state.set({ scan: nearest ?? index });
  }

  #slide() {
    this.go(this.#scans()[Number(this.slider.value)]);
  }

  step(by) {
    const scans = this.#scans();
    if (scans.length === 0) return;
    const at = scans.indexOf(this.state.get('scan'));
    this.go(scans[Math.min(Math.max(at + by, 0), scans.length - 1)]);
  }

  edge(last) {
    const scans = this.#scans();
    if (scans.length > 0) this.go(last ? scans.at(-1) : scans[0]);
  }

  /** From the worst scan to the next worse one, in circles. */
  nextWorst() {
    const drawable = new Set(this.#scans());
    const worst = worstScans(this.#result()).filter((k) => drawable.has(k));
    if (worst.length === 0) {
      this.message.textContent = 'No scan with points in this file has a false one.';
      return;
    }
    this.go(worst[(worst.indexOf(this.state.get('scan')) + 1) % worst.length]);
  }

  toggle() {
    if (this.timer) {
      clearInterval(this.timer);
      this.timer = null;
    } else {
      this.timer = setInterval(() => this.#advance(), FRAME_MS);
    }
    this.play.textContent = this.timer ? '❚❚' : '▶';
  }

  #advance() {
    const scans = this.#scans();
    this.go(scans[(scans.indexOf(this.state.get('scan')) + 1) % scans.length]);
  }
}
