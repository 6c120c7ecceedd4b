"""Labels scans for `mosbench run DATA --method "exec:python3 client.py"`: a point moves when its voxel
was empty in all scans before. Put a network in place of `label`. docs/formats/exec.md has the messages.
"""

import json
import struct
import sys

import numpy as np

STATIC, MOVING = 9, 251
VOXEL_SIZE_M = 0.5
SHIFT = 1 << 20  # voxels per axis, half of them negative


def read_exactly(count):
    """Returns so many bytes of stdin; none when it was closed."""
    data = sys.stdin.buffer.read(count)
    return data if len(data) == count else b""


def receive():
    """Returns tag and payload of the next message; both empty after the last."""
    header = read_exactly(16)
    if not header:
        return b"", b""
    tag, size = struct.unpack("<8sQ", header)
    return tag, read_exactly(size)


def send(tag, payload):
    sys.stdout.buffer.write(struct.pack("<8sQ", tag, len(payload)) + payload)
    sys.stdout.buffer.flush()


def label(points, map_from_sensor, seen, is_first, voxel_size_m):
    """Returns labels (N,) and scores (N,); adds the voxels of the scan to `seen`."""
    x, y, z = (points[:, axis].astype(np.float64) for axis in range(3))
    # Column by column: a product of matrices rounds in another order on every machine.
    in_map = [row[0] * x + row[1] * y + row[2] * z + row[3] for row in map_from_sensor]
    finite = [np.where(np.isfinite(axis), axis, 0.0) for axis in in_map]
    voxels = [np.floor(axis / voxel_size_m).astype(np.int64) + SHIFT // 2 for axis in finite]
    keys = (voxels[0] * SHIFT + voxels[1]) * SHIFT + voxels[2]
    is_new = np.array([key not in seen for key in keys.tolist()], dtype=bool)
    seen.update(keys.tolist())
    moving = is_new & (not is_first)
    return np.where(moving, MOVING, STATIC).astype("<u4"), moving.astype("<f4")


def main():
    tag, payload = receive()
    version, columns, scan_count, wants_scores, _ = struct.unpack_from("<IIQII", payload)
    if tag != b"MOShello" or version not in (1, 2):
        sys.exit(f"client.py: speaks versions 1 and 2, not {version}")
    settings = json.loads(payload[24:]) if version == 2 else {}
    voxel_size_m = settings.get("voxel_size_m", VOXEL_SIZE_M)
    print(f"client.py: {scan_count} scans will come", file=sys.stderr)  # stdout is for messages
    send(b"MOSready", struct.pack("<II", version, wants_scores))
    seen = set()
    while True:
        tag, payload = receive()
        if not tag:
            return
        index, stamp_ns = struct.unpack_from("<Qq", payload)
        map_from_sensor = np.frombuffer(payload, "<f8", 12, 16).reshape(3, 4)
        (count,) = struct.unpack_from("<Q", payload, 112)
        points = np.frombuffer(payload, "<f4", count * columns, 120).reshape(count, columns)
        labels, scores = label(points, map_from_sensor, seen, index == 0, voxel_size_m)
        answer = struct.pack("<QQ", index, count) + labels.tobytes()
        send(b"MOSlabel", answer + (scores.tobytes() if wants_scores else b""))


main()
