import { outcomesFromPlane, positionsFromPlanes, readBlock, scoresFromPlanes } from './payload.js';

const SCANS_KEPT = 24;

/** The scans whose points are in the file, unpacked when they are first looked at. */
export class Clouds {
  #content;
  #kept = new Map();

  constructor(content) {
    this.#content = content;
  }

  #cloudOf(result) {
    return this.#content.clouds[this.#content.results[result].cloud];
  }

  /** Indices of the scans of a result that can be drawn, in order. */
  scansOf(result) {
    return this.#cloudOf(result)?.scans.map((scan) => scan.index) ?? [];
  }

  /** Whether the points of a result have dynamic scores. */
  hasScores(result) {
    return (this.#content.results[result].scores ?? []).length > 0;
  }

  leftOut(result) {
    return this.#cloudOf(result)?.left_out ?? 'the file holds no points';
  }

  /** Other results of the same scans. */
  comparable(result) {
    const { results } = this.#content;
    return results.flatMap((other, i) => (i !== result && other.cloud !== undefined && other.cloud === results[result].cloud ? [i] : []));
  }

  /** The drawable scan nearest to `index`. */
  nearest(result, index) {
    return this.scansOf(result).reduce(
      (best, k) => (best === null || Math.abs(k - index) < Math.abs(best - index) ? k : best),
      null,
    );
  }

  /**
   * {points, positions_m, outcomes, drawable, scores, pose}, or null when its points were left out;
   * scores are null where the run kept none.
   */
  async read(result, index) {
    const key = `${result}/${index}`;
    if (!this.#kept.has(key)) this.#kept.set(key, this.#unpack(result, index));
    const scan = this.#kept.get(key);
    this.#kept.delete(key); // the last used one is the last to go
    this.#kept.set(key, scan);
    while (this.#kept.size > SCANS_KEPT) this.#kept.delete(this.#kept.keys().next().value);
    return scan;
  }

  async #unpack(result, index) {
    const scans = this.#cloudOf(result)?.scans ?? [];
    const place = scans.findIndex((scan) => scan.index === index);
    if (place < 0) return null;
    const { outcomes, scores } = this.#content.results[result];
    const [planes, plane, scorePlanes] = await Promise.all([
      readBlock(scans[place].positions),
      readBlock(outcomes[place]),
      this.hasScores(result) ? readBlock(scores[place]) : null,
    ]);
    return {
      points: scans[place].points,
      stem: scans[place].stem,
      positions_m: positionsFromPlanes(planes, this.#content.position_step_m),
      pose: scans[place].map_from_sensor,
      ...outcomesFromPlane(plane),
      scores: scorePlanes && scoresFromPlanes(scorePlanes),
    };
  }
}
