/** The film of a track from above, on a square canvas. Places are [x, y] in centimetres from its middle. */

const COLOURS = { around: '#888', others: '#0072b2', track: '#e8430c', trail: '#e8430c33', drawn: '#c2185b' };

export class Film {
  data = null;
  frame = 0;
  playing = true;

  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
  }

  load(data, scan = null) {
    this.data = data;
    this.frame = Math.max(0, data.frames.findIndex((frame) => frame.scan === scan));
  }

  now() {
    return this.data?.frames[this.frame];
  }

  step(frames) {
    const count = this.data?.frames.length ?? 0;
    if (count > 0) this.frame = (this.frame + frames + count) % count;
  }

  placeOf(event) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const half = this.data.half_cm;
    return [(2 * (event.clientX - left) / width - 1) * half, (1 - 2 * (event.clientY - top) / height) * half];
  }

  /** In the map, in metres. */
  metres([x, y]) {
    return [this.data.middle_m[0] + x / 100, this.data.middle_m[1] + y / 100];
  }

  /** The number of the other track that is nearest to a place, and near enough for a finger; null without one. */
  otherAt([x, y]) {
    let [found, least] = [null, this.data.half_cm / 10];
    for (const [number, points] of Object.entries(this.now().others)) {
      for (let i = 0; i < points.length; i += 3) {
        const distance = Math.hypot(points[i] - x, points[i + 1] - y);
        if (distance < least) [found, least] = [number, distance];
      }
    }
    return found;
  }

  #pixel([x, y]) {
    const half = this.canvas.width / 2;
    return [half + (x * half) / this.data.half_cm, half - (y * half) / this.data.half_cm];
  }

  #dots(points, colour, size) {
    this.context.fillStyle = colour;
    for (let i = 0; i < points.length; i += 3) {
      const [x, y] = this.#pixel([points[i], points[i + 1]]);
      this.context.fillRect(x - size / 2, y - size / 2, size, size);
    }
  }

  #drawn({ corners, cursor }) {
    const { context } = this;
    context.strokeStyle = context.fillStyle = COLOURS.drawn;
    context.lineWidth = 3;
    context.beginPath();
    for (const corner of corners) context.lineTo(...this.#pixel(corner));
    context.closePath();
    context.stroke();
    for (const corner of corners) {
      const [x, y] = this.#pixel(corner);
      context.fillRect(x - 5, y - 5, 10, 10);
    }
    const [x, y] = this.#pixel(cursor);
    context.strokeRect(x - 12, y, 24, 0);
    context.strokeRect(x, y - 12, 0, 24);
  }

  draw(drawing) {
    const now = this.now();
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (!now) return;
    this.#dots(now.around, COLOURS.around, 2);
    for (const points of Object.values(now.others)) this.#dots(points, COLOURS.others, 3);
    for (let i = 0; i < this.frame; i += 1) this.#dots(this.data.frames[i].track, COLOURS.trail, 3);
    this.#dots(now.track, COLOURS.track, 5);
    this.context.fillStyle = COLOURS.around;
    this.context.font = '22px sans-serif';
    this.context.fillText(`scan ${now.scan}, ${(this.data.half_cm / 50).toFixed(0)} m across`, 12, 28);
    if (drawing) this.#drawn(drawing);
  }
}
