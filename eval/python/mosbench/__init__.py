"""Moving object segmentation of LiDAR scans, and scores of anybody's labels.

    import mosbench
    mos = mosbench.MOS(mosbench.Config.preset("doals-20m"))
    for points, pose in scans:                 # (N, 3) or (N, 4) metres in the sensor frame; (4, 4)
        for result in mos.push(points, pose):  # the scans whose labels became final
            result.moving                      # bool (N,)

Wrong values raise ValueError, unusable files OSError, both with the message of the program.
"""

from mosbench._mosbench import MOVING_LABEL, STATIC_LABEL, __version__
from mosbench._mosbench import method_names as methods
from mosbench._mosbench import preset_names as presets
from mosbench._mosbench import protocol_names as protocols
from mosbench.commands import (
    Checkup,
    Comparison,
    breakdown,
    compare,
    curve,
    diff,
    doctor,
    evaluate_trajectory,
    map_score,
    rank,
    run,
    score,
    simulate,
    stats,
    table,
)
from mosbench.datasets import Dataset, Scan, Sequence, open
from mosbench.flags import READING
from mosbench.flow import moving_for_h5
from mosbench.metrics import confusion, iou, mean_of_scans, metrics, pooled
from mosbench.online import MOS, Config, Labels, Odometry, OdometryPose, odometry
from mosbench.poses import write_poses
from mosbench.results import Result, SequenceResult

__all__ = [
    "Checkup",
    "Comparison",
    "Config",
    "Dataset",
    "Labels",
    "MOS",
    "MOVING_LABEL",
    "Odometry",
    "OdometryPose",
    "READING",
    "Result",
    "STATIC_LABEL",
    "Scan",
    "Sequence",
    "SequenceResult",
    "__version__",
    "breakdown",
    "compare",
    "confusion",
    "curve",
    "diff",
    "doctor",
    "evaluate_trajectory",
    "iou",
    "map_score",
    "mean_of_scans",
    "methods",
    "metrics",
    "moving_for_h5",
    "odometry",
    "open",
    "pooled",
    "presets",
    "protocols",
    "rank",
    "run",
    "score",
    "simulate",
    "stats",
    "table",
    "write_poses",
]
