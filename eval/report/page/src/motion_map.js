/** All moving points of the scans in the file, in the map's frame. */

const SHOWN = [true, true, true, false, false, true]; // tp, fp, fn, and moving without truth

/** p_map = map_from_sensor * p_sensor, relative to `origin`. */
export function toMap(pose, x, y, z, origin) {
  return [0, 4, 8].map((r, i) => pose[r] * x + pose[r + 1] * y + pose[r + 2] * z + pose[r + 3] - origin[i]);
}

const CELL_M = 0.4;
const MOST_CELLS = 400000;

/** Points of what stands still, one per cell, in the frame of the map: where the moving ones were. */
export class StillPoints {
  #cells = new Set();
  #positions_m = [];

  add({ points, positions_m, outcomes, drawable, pose }, origin) {
    for (let i = 0; i < points && this.#cells.size < MOST_CELLS; ++i) {
      if (SHOWN[outcomes[i]] || !drawable[i]) continue;
      const at = toMap(pose, positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2], origin);
      const cell = at.reduce((key, m) => 131072 * key + Math.floor(m / CELL_M) + 65536, 0);
      if (this.#cells.has(cell)) continue;
      this.#cells.add(cell);
      this.#positions_m.push(...at);
    }
  }

  positions_m() {
    return Float32Array.from(this.#positions_m);
  }
}

function shownPoints({ outcomes, drawable }) {
  let shown = 0;
  for (let i = 0; i < outcomes.length; ++i) shown += SHOWN[outcomes[i]] && drawable[i] ? 1 : 0;
  return shown;
}

/** What of one scan belongs to the map. */
export function movingPoints(scan, origin) {
  const points = shownPoints(scan);
  const moving = {
    positions_m: new Float32Array(3 * points),
    outcomes: new Uint8Array(points),
    scores: scan.scores ? new Float32Array(points) : null,
    reasons: scan.reasons ? new Uint8Array(points) : null,
    velocities_m_s: scan.velocities_m_s ? new Float32Array(points) : null,
    eye: toMap(scan.pose, 0, 0, 0, origin),
  };
  let next = 0;
  for (let i = 0; i < scan.points; ++i) {
    if (!SHOWN[scan.outcomes[i]] || !scan.drawable[i]) continue;
    moving.positions_m.set(toMap(scan.pose, scan.positions_m[3 * i], scan.positions_m[3 * i + 1], scan.positions_m[3 * i + 2], origin), 3 * next);
    if (scan.scores) moving.scores[next] = scan.scores[i];
    if (scan.reasons) moving.reasons[next] = scan.reasons[i];
    if (scan.velocities_m_s) moving.velocities_m_s[next] = scan.velocities_m_s[i];
    moving.outcomes[next++] = scan.outcomes[i];
  }
  return moving;
}

/** Joins the moving points of scans to one that can be drawn like a scan. */
export function join(parts) {
  const points = parts.reduce((sum, part) => sum + part.outcomes.length, 0);
  const cloud = {
    points,
    stem: `${parts.length} scans`,
    positions_m: new Float32Array(3 * points),
    outcomes: new Uint8Array(points),
    scores: parts.every((part) => part.scores) ? new Float32Array(points) : null,
    reasons: parts.every((part) => part.reasons) ? new Uint8Array(points) : null,
    velocities_m_s: parts.every((part) => part.velocities_m_s) ? new Float32Array(points) : null,
    drawable: new Uint8Array(points).fill(1),
    path: parts.map((part) => part.eye),
    pose: null,
  };
  let next = 0;
  for (const part of parts) {
    cloud.positions_m.set(part.positions_m, 3 * next);
    cloud.outcomes.set(part.outcomes, next);
    cloud.scores?.set(part.scores, next);
    cloud.reasons?.set(part.reasons, next);
    cloud.velocities_m_s?.set(part.velocities_m_s, next);
    next += part.outcomes.length;
  }
  return cloud;
}
