/**
 * The drawn point under the pointer: of those within `reach` pixels the one nearest to the eye.
 * `clip` is the camera's 4x4 projection * view matrix, columns first; x and y are pixels in a view
 * of width and height. @returns the point's index or -1.
 */
export function pick(positions_m, sizes, clip, { x, y, width, height }, reach = 8) {
  let found = -1;
  let nearest = Infinity;
  for (let i = 0; i < sizes.length; ++i) {
    if (sizes[i] === 0) continue;
    const [px, py, pz] = [positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2]];
    const w = clip[3] * px + clip[7] * py + clip[11] * pz + clip[15];
    if (w <= 0 || w >= nearest) continue;
    const across = ((clip[0] * px + clip[4] * py + clip[8] * pz + clip[12]) / w + 1) * 0.5 * width - x;
    const down = (1 - (clip[1] * px + clip[5] * py + clip[9] * pz + clip[13]) / w) * 0.5 * height - y;
    if (across * across + down * down > reach * reach) continue;
    found = i;
    nearest = w;
  }
  return found;
}
