#pragma once

#include <string>

namespace mosbench {

/// Returns a short scene with every kind of record.
inline std::string example_scene_json() {
  return R"({
  "name": "crossing",
  "scan_period_s": 0.1,
  "ego": {
    "carrier": "ground-robot",
    "sensor_height_m": 0.9,
    "route": {
      "from_m": [0, 0],
      "legs": [{"to_m": [12, 0], "speed_m_s": 1.0}, {"to_m": [12, 8], "speed_m_s": 0.8, "wait_s": 2}]
    }
  },
  "ground": [{"height_m": 0, "slope_x": 0.01}],
  "structures": [
    {"shape": "box", "center_m": [6, 9, 2], "size_m": [20, 0.3, 4]},
    {"shape": "box", "center_m": [6, -6, 2], "size_m": [20, 0.3, 4], "yaw_rad": 0.1},
    {"shape": "cylinder", "center_m": [4, 3, 2], "size_m": [0.3, 0.3, 4]},
    {"shape": "sphere", "center_m": [15, 4, 3], "size_m": [3, 3, 3], "density": 0.35}
  ],
  "movers": [
    {"kind": "pedestrian", "route": {
      "from_m": [3, 6], "after": "return",
      "legs": [{"to_m": [10, 6], "speed_m_s": 1.3}, {"to_m": [10, -4], "speed_m_s": 1.1, "wait_s": 2}]}},
    {"kind": "cyclist", "route": {
      "from_m": [-10, -3], "after": "restart", "legs": [{"to_m": [40, -3], "speed_m_s": 4}]}},
    {"kind": "car", "route": {
      "from_m": [30, -4], "start_s": 1, "legs": [{"to_m": [-30, -4], "speed_m_s": 7}]}}
  ],
  "doors": [{"hinge_m": [8, 8.7], "width_m": 1.1, "closed_yaw_rad": 0, "open_yaw_rad": -1.4}],
  "balls": [{"from_m": [9, 4, 1.5], "velocity_m_s": [-3, 1, 4]}]
}
)";
}

}  // namespace mosbench
