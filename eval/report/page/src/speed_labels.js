import { placeIn, raised, speedText, topOf } from './boxes.js';
import { element } from './dom.js';

/** As the style sheet has it: over the place, on a ground that shows the points behind it a little. */
function drawLabel(context, label, { x, y }) {
  const { color, backgroundColor, font, opacity } = globalThis.getComputedStyle(label);
  const [width, height] = [label.offsetWidth, label.offsetHeight];
  Object.assign(context, { font, globalAlpha: Number(opacity), textAlign: 'center', textBaseline: 'middle' });
  context.fillStyle = backgroundColor;
  context.fillRect(x - width / 2, y - 1.1 * height, width, height);
  context.fillStyle = color;
  context.fillText(label.textContent, x, y - 0.6 * height);
}

/** The speeds of boxes, written over the panes; they follow the camera. */
export class SpeedLabels {
  node = element('div', { class: 'speeds', 'aria-hidden': 'true' });

  constructor(stage) {
    this.stage = stage;
    this.boxes = [];
    stage.onDrawn = () => this.place();
  }

  /** `boxes` of each pane. */
  fill(boxes) {
    this.boxes = boxes;
    this.labels = boxes.map((ofPane) => ofPane.map((box) => element('span', {}, speedText(box))));
    this.node.replaceChildren(...this.labels.flat());
  }

  place() {
    for (const { label, at } of this.#places()) {
      label.style.display = at ? '' : 'none';
      if (!at) continue;
      label.style.left = `${at.x}px`;
      label.style.top = `${at.y}px`;
    }
  }

  /** Writes them into a picture of the stage, in `ratio` pixels per pixel of the page. */
  draw(picture, ratio) {
    const context = picture.getContext('2d');
    context.scale(ratio, ratio);
    for (const { label, at } of this.#places()) if (at) drawLabel(context, label, at);
  }

  /** Each label and where it belongs in the stage, above others in its way; null outside of its pane. */
  #places() {
    const { columns, width, height } = this.stage.grid();
    const clip = this.stage.clipMatrix();
    const size = this.#size();
    return this.boxes.flatMap((ofPane, p) => {
      const taken = [];
      const corner = { x: (p % columns) * width, y: Math.floor(p / columns) * height };
      return ofPane.map((box, b) => {
        const at = speedText(box) ? placeIn(topOf(box), clip, { width, height }) : null;
        if (!at) return { label: this.labels[p][b], at };
        const { x, y } = raised(at, taken, size);
        return { label: this.labels[p][b], at: { x: corner.x + x, y: corner.y + y } };
      });
    });
  }

  /** Of one label; all are nearly as large. It is measured once, or each picture would lay out the page again. */
  #size() {
    const label = this.labels?.flat().find((node) => node.textContent !== '');
    if (label && !(this.size?.width > 0)) {
      label.style.display = '';
      this.size = { width: label.offsetWidth, height: label.offsetHeight };
    }
    return this.size ?? { width: 0, height: 0 };
  }
}
