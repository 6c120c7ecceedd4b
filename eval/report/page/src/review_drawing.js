/** A polygon, or a place, that a person sets by taps or by the cursor. Places are [x, y] in centimetres. */

const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Drawing {
  corners = [];
  cursor = [0, 0];

  /** `kind`: split, paint or merge; `done` is called when the drawing is whole. */
  constructor(kind, half_cm, done) {
    Object.assign(this, { kind, half_cm, done });
  }

  add(place) {
    this.cursor = place;
    this.corners.push(place);
    return this.kind === 'merge' ? this.done(this) : null;
  }

  /** Whether the key is one of drawing; Shift moves further. */
  takes(key) {
    return key in MOVES || key === 'Enter' || key === 'Backspace';
  }

  press(key, isFar) {
    if (key === 'Enter') return this.add(this.cursor);
    if (key === 'Backspace') {
      this.corners.pop();
      return null;
    }
    const step = this.half_cm / (isFar ? 8 : 40);
    this.cursor = this.cursor.map((at, axis) => Math.max(-this.half_cm, Math.min(this.half_cm, at + MOVES[key][axis] * step)));
    return null;
  }
}
