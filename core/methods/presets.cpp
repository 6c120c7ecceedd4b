#include <mosbench/method.hpp>

namespace mosbench {
namespace {

std::vector<PresetValue> settings(double voxel_size_m, double min_range_m, double max_range_m,
                                  int delay_scans = 0) {
  return {{"voxel_size_m", voxel_size_m},
          {"min_range_m", min_range_m},
          {"max_range_m", max_range_m},
          {"delay_scans", delay_scans}};
}

/// The same for DOALS, whose sensor Dynablox's authors describe so (their default.yaml).
std::vector<PresetValue> doals_settings(double max_range_m) {
  std::vector<PresetValue> values = settings(0.20, 0.5, max_range_m);
  values.push_back({"range_image_rows", 64});
  values.push_back({"range_image_columns", 2048});
  values.push_back({"field_of_view_down_deg", -33.22222 / 2});
  values.push_back({"field_of_view_up_deg", 33.22222 / 2});
  return values;
}

/// The same for the authors' later program, with which they measured these data sets.
std::vector<PresetValue> later_settings(double voxel_size_m, double min_range_m,
                                        double max_range_m) {
  std::vector<PresetValue> values = settings(voxel_size_m, min_range_m, max_range_m);
  values.push_back({"variant", "release-2025"});
  values.push_back({"local_window_scans", 5});
  return values;
}

}  // namespace

std::span<const MethodPreset> method_presets() {
  static const std::vector<MethodPreset> kPresets = {
      {"doals-20m", doals_settings(20.0), "paper, Table I, rows (20m)"},
      {"doals-120m", doals_settings(120.0), "paper, Table I, full range"},
      {"sipailou", settings(0.25, 3.0, 50.0), "paper, Table II"},
      {"helimos", settings(0.25, 1.5, 50.0), "paper, Table III, online"},
      {"helimos-delayed", settings(0.25, 1.5, 50.0, 10), "paper, Table III, delayed by 10 scans"},
      {"semantickitti", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"apollo", settings(0.25, 0.5, 120.0), "authors' config of Apollo (2024)"},
      {"moe", later_settings(0.20, 0.0, 120.0), "authors' config of MOE (2025)"},
      {"kth", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"mdetector", later_settings(0.20, 0.0, 120.0),
       "authors' config of M-detector's sets (2025)"},
      {"opensceneflow", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"nuscenes", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"helipr", settings(0.25, 1.5, 50.0), "ours, HeLiPR has no labels: as helimos"},
      {"kitti-raw", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"kitti-tracking", settings(0.25, 1.5, 50.0), "ours, the authors publish none: as helimos"},
      {"recording", settings(0.25, 1.5, 50.0), "ours, for recordings of any sensor: as helimos"},
      {"mid-360", {{"voxel_size_m", 0.15}}, "ours, docs/history/studies.md: thin scans all round"},
      {"best", {}, "ours, docs/history/plus/README.md", "hmm-mos-plus"},
      {"offline",
       {{"delay_scans", 0}, {"track_window_s", 60.0}},
       "ours, docs/history/plus/README.md",
       "hmm-mos-plus"},
  };
  return kPresets;
}

}  // namespace mosbench
