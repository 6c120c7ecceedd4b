import { hasLabels } from './metrics.js';
import { outcomesFromPlane, positionsFromPlanes, readBlock, scoresFromPlanes, velocitiesFromPlanes } from './payload.js';

const SCANS_KEPT = 24;

/** What `make` gives for a key, kept for the next time; the last used one is the last to go. */
function keep(kept, key, make) {
  const value = kept.get(key) ?? make();
  kept.delete(key);
  kept.set(key, value);
  while (kept.size > SCANS_KEPT) kept.delete(kept.keys().next().value);
  return value;
}

/** The scans whose points are in the file, unpacked when they are first looked at. */
export class Clouds {
  #content;
  #kept = new Map();
  #positions = new Map(); // of scans, shared by all runs

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

  /** What the scores of a result measure. */
  scoreName(result) {
    return this.#content.results[result].score_name ?? 'score';
  }

  /** Results whose scores are of one kind have a common scale. */
  scoreKind(result) {
    return `${this.#content.results[result].result.method?.name}: ${this.scoreName(result)}`;
  }

  /** Whether the points of a result have scores. */
  hasScores(result) {
    return (this.#content.results[result].scores ?? []).length > 0;
  }

  /** Whether the run kept why its points move. */
  hasReasons(result) {
    return (this.#content.results[result].reasons ?? []).length > 0;
  }

  /** Whether the sensor measured how fast its points move along their rays. */
  hasVelocities(result) {
    const scans = this.#cloudOf(result)?.scans ?? [];
    return scans.length > 0 && scans.every((scan) => scan.radial_velocities !== undefined);
  }

  leftOut(result) {
    const none = this.#content.clouds.length > 0 ? 'the file holds no points of this run' : 'the file holds no points';
    return this.#cloudOf(result)?.left_out ?? none;
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
   * {points, positions_m, outcomes, drawable, scores, reasons, velocities_m_s, pose, unscored}, or null when its points
   * were left out; scores and reasons are null where the run kept none, velocities where the sensor measures none.
   */
  async read(result, index) {
    return keep(this.#kept, `${result}/${index}`, () => this.#unpack(result, index));
  }

  #positionsOf(block) {
    return keep(this.#positions, block, async () => positionsFromPlanes(await readBlock(block), this.#content.position_step_m));
  }

  async #unpack(result, index) {
    const scans = this.#cloudOf(result)?.scans ?? [];
    const place = scans.findIndex((scan) => scan.index === index);
    if (place < 0) return null;
    const { outcomes, scores, reasons } = this.#content.results[result];
    const [positions_m, plane, scorePlanes, reasonPlane, velocityPlanes] = await Promise.all([
      this.#positionsOf(scans[place].positions),
      readBlock(outcomes[place]),
      this.hasScores(result) ? readBlock(scores[place]) : null,
      this.hasReasons(result) ? readBlock(reasons[place]) : null,
      this.hasVelocities(result) ? readBlock(scans[place].radial_velocities) : null,
    ]);
    return {
      points: scans[place].points,
      stem: scans[place].stem,
      positions_m,
      pose: scans[place].map_from_sensor,
      boxes: this.#content.results[result].boxes?.[place] ?? [],
      unscored: !hasLabels(this.#content.results[result].result.scans[index]),
      ...outcomesFromPlane(plane),
      scores: scorePlanes && scoresFromPlanes(scorePlanes),
      reasons: reasonPlane,
      velocities_m_s: velocityPlanes && velocitiesFromPlanes(velocityPlanes, this.#content.velocity_step_m_s),
    };
  }
}
