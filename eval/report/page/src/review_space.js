import { Stage } from './stage.js';
import { rgb, surface } from './theme.js';

const PARTS = [['around', '#888888', 2], ['others', '#0072b2', 3], ['track', '#e8430c', 4]];

/** What of a frame belongs to a part, as [x, y, z, ...] in centimetres. */
function pointsOf(frame, part) {
  return part === 'others' ? Object.values(frame.others).flat() : frame[part];
}

/** The shown frame in 3-D. Shows nothing in a browser without WebGL. */
export class Space {
  #angle = -2.2;

  constructor(canvas, theme) {
    try {
      this.stage = new Stage(canvas);
    } catch {
      canvas.hidden = true;
      return;
    }
    this.stage.setTheme(surface(theme));
    this.stage.show(1);
  }

  /** Looks at the track from the side; by 0 after another film was loaded. */
  turn(by, half_cm) {
    if (!this.stage) return;
    this.#angle += by;
    const away_m = Math.min(half_cm / 100, 30);
    this.stage.look({ eye: [away_m * Math.cos(this.#angle), away_m * Math.sin(this.#angle), 0.6 * away_m], target: [0, 0, 0.5], angle: 55 });
  }

  show(frame) {
    if (!this.stage || !frame || frame === this.shown) return;
    this.shown = frame;
    const positions = [], colours = [], sizes = [];
    for (const [part, colour, size] of PARTS) {
      const points = pointsOf(frame, part);
      for (let i = 0; i < points.length; i += 3) {
        positions.push(points[i] / 100, points[i + 1] / 100, points[i + 2] / 100);
        colours.push(...rgb(colour));
        sizes.push(size);
      }
    }
    this.stage.panes[0].fill(new Float32Array(positions), new Uint8Array(colours), new Float32Array(sizes), null, null);
    this.stage.draw();
  }
}
