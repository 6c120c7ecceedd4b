"""Writes inputs in formats that mosbench reads but does not write."""

import struct


def points_of(bin_bytes):
    """[(x, y, z, intensity)] of a .bin scan."""
    return [point for point in struct.iter_unpack("<4f", bin_bytes)]


def labels_of(label_bytes):
    return [label & 0xFFFF for (label,) in struct.iter_unpack("<I", label_bytes)]


def _moves(label):
    return 251 <= label <= 259


def _literal_lzf(data):
    """LZF without any back reference: runs of at most 32 literal bytes."""
    return b"".join(bytes([len(run) - 1]) + run for run in (data[i:i + 32] for i in range(0, len(data), 32)))


def pcd(points, encoding):
    count = len(points)
    header = (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\n"
        f"TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\n"
        f"DATA {encoding}\n"
    ).encode()
    if encoding == "ascii":
        return header + "".join("%.6g %.6g %.6g %.6g\n" % point for point in points).encode()
    if encoding == "binary":
        return header + b"".join(struct.pack("<4f", *point) for point in points)
    # Compressed files hold one field after the other.
    columns = b"".join(struct.pack(f"<{count}f", *column) for column in zip(*points))
    packed = _literal_lzf(columns)
    return header + struct.pack("<II", len(packed), len(columns)) + packed


def timed_pcd(points, encoding):
    """Points with a field of nanoseconds after the stamp, as Ouster's."""
    count = len(points)
    lines = ["VERSION 0.7", "FIELDS x y z t", "SIZE 4 4 4 4", "TYPE F F F U", "COUNT 1 1 1 1", f"WIDTH {count}",
             "HEIGHT 1", f"POINTS {count}", f"DATA {encoding}"]
    rows = [(x, y, z, i * 100_000_000 // count) for i, (x, y, z, _) in enumerate(points)]
    if encoding == "ascii":
        body = "".join("%.6g %.6g %.6g %d\n" % row for row in rows).encode()
    else:
        body = b"".join(struct.pack("<3fI", *row) for row in rows)
    return "".join(f"{line}\n" for line in lines).encode() + body


def timed_ply(points, encoding):
    """Points with a property of seconds after the stamp, as Velodyne's driver tells them."""
    properties = "".join(f"property {kind}\n" for kind in ("float x", "float y", "float z", "double time"))
    header = f"ply\nformat {encoding} 1.0\nelement vertex {len(points)}\n{properties}end_header\n".encode()
    rows = [(x, y, z, 0.1 * i / len(points)) for i, (x, y, z, _) in enumerate(points)]
    if encoding == "ascii":
        return header + "".join("%.6g %.6g %.6g %.9g\n" % row for row in rows).encode()
    return header + b"".join(struct.pack("<3fd", *row) for row in rows)


def truth_pcd(points, labels, encoding):
    """A cloud whose intensity says what moves, as KTH's."""
    return pcd([(x, y, z, float(_moves(label))) for (x, y, z, _), label in zip(points, labels)], encoding)


def label_file(labels):
    return struct.pack(f"<{len(labels)}I", *labels)


def ply(points, encoding):
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "intensity"))
    header = f"ply\nformat {encoding} 1.0\nelement vertex {len(points)}\n{properties}end_header\n".encode()
    if encoding == "ascii":
        return header + "".join("%.6g %.6g %.6g %.6g\n" % point for point in points).encode()
    order = "<" if encoding == "binary_little_endian" else ">"
    return header + b"".join(struct.pack(order + "4f", *point) for point in points)


def tum(kitti_poses, stamps):
    """Poses of a sensor that only moves: the translations of KITTI rows, without rotation."""
    rows = [row.split() for row in kitti_poses.decode().splitlines()]
    return "".join(f"{stamp} {row[3]} {row[7]} {row[11]} 0 0 0 1\n" for stamp, row in zip(stamps, rows)).encode()


def rollout(kitti_poses):
    rows = [row.split() for row in kitti_poses.decode().splitlines()]
    return "".join(f"{row[3]},{row[7]},{row[11]},0,0,0,1\n" for row in rows).encode()


def moe_labels(labels):
    return "".join("1 1 3\n" if _moves(label) else "0 0 -1\n" for label in labels).encode()


def moving_csv(labels):
    return ("index,moving\n" + "".join(f"{i},{int(_moves(label))}\n" for i, label in enumerate(labels))).encode()


def rows(scans):
    """[(key, moving points)] as lines: the key, then the indices of the points."""
    return "".join(",".join(map(str, [key, *sorted(moving)])) + "\n" for key, moving in scans).encode()


def dynablox_clouds(scans):
    """[(points, moving points)] as clouds.csv."""
    text = "CloudNo,X,Y,Z,Distance,PointDynamic,ClusterDynamic,ObjectDynamic,GTDynamic,ReadyForEvaluation,ClusterID\n"
    for number, (points, moving) in enumerate(scans):
        for i, (x, y, z, _) in enumerate(points):
            m = int(i in moving)
            text += f"{number},{x:.4g},{y:.4g},{z:.4g},{(x * x + y * y + z * z) ** 0.5:.4g},{m},{m},{m},{m},1,{m - 1}\n"
    return text.encode()


def dynablox_scores(scans):
    """[(stamp_ns, points, moving points)] as scores.csv of predictions without a mistake."""
    text = "timestamp" + ",number_of_a_level" * 21 + ",EvaluatedPoints,TotalPoints\n"
    for stamp_ns, points, moving in scans:
        level = f",1,1,1,{len(moving)},{len(points) - len(moving)},0,0"
        text += f"{stamp_ns}{level * 3},{len(points)},{len(points)}\n"
    return text.encode()
