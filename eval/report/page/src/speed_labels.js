import { placeIn, speedText, topOf } from './boxes.js';
import { element } from './dom.js';

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
    const { columns, width, height } = this.stage.grid();
    const clip = this.stage.clipMatrix();
    this.boxes.forEach((ofPane, p) => ofPane.forEach((box, b) => {
      const at = placeIn(topOf(box), clip, { width, height });
      const { style } = this.labels[p][b];
      style.display = at ? '' : 'none';
      if (!at) return;
      style.left = `${(p % columns) * width + at.x}px`;
      style.top = `${Math.floor(p / columns) * height + at.y}px`;
    }));
  }
}
