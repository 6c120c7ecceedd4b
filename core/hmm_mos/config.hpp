#pragma once

#include <optional>
#include <string_view>

namespace mosbench {

/// Which of the authors' two programs is reproduced; algorithm differences are listed at
/// `Pipeline`.
enum class Variant { kPaper2024, kRelease2025 };

std::string_view to_string(Variant variant);
/// Nothing when the name is neither "paper-2024" nor "release-2025".
std::optional<Variant> variant_from_string(std::string_view name);

/// Every parameter of the method; the defaults are the paper's (DOALS, 20 m).
struct Config {
  double voxel_size_m = 0.20;               ///< Delta
  std::optional<double> occupancy_sigma_m;  ///< sigma_o; the voxel size when not set
  double min_range_m = 0.5;                 ///< points at or nearer than this never take part
  double max_range_m = 20.0;                ///< voxels farther than this are not observed
  int delay_scans = 0;                      ///< n; 0 is online
  int local_window_scans = 3;               ///< w_l
  int global_window_scans = 300;            ///< w_g
  int dynamic_window_scans = 100;           ///< w_d, paper-2024 only
  int kernel_width_voxels = 5;              ///< m, odd
  double min_state_probability = 0.99;      ///< p_min, compared with strict >
  int min_otsu_score = 3;                   ///< otsu_min, compared with strict >
  double transition_epsilon = 0.005;        ///< epsilon
  int distance_field_scans = 2;             ///< 2 as the authors' program, 1 as the paper's text

  double sigma_m() const { return occupancy_sigma_m.value_or(voxel_size_m); }
};

/// Closed interval of legal values of a numeric field.
struct FieldRange {
  double lowest, highest;
};

/// The one list of fields: calls `visit(name, member, legal_range)` for each. Reading, writing and
/// checking of configurations all walk it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0});
  visit("occupancy_sigma_m", config.occupancy_sigma_m, FieldRange{0.001, 100.0});
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0});
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0});
  visit("delay_scans", config.delay_scans, FieldRange{0, 1000});
  visit("local_window_scans", config.local_window_scans, FieldRange{1, 1000});
  visit("global_window_scans", config.global_window_scans, FieldRange{1, 30000});
  visit("kernel_width_voxels", config.kernel_width_voxels, FieldRange{1, 15});
  visit("min_state_probability", config.min_state_probability, FieldRange{0.5, 0.999999});
  visit("min_otsu_score", config.min_otsu_score, FieldRange{0, 1000000});
  visit("transition_epsilon", config.transition_epsilon, FieldRange{1e-6, 0.499});
  visit("dynamic_window_scans", config.dynamic_window_scans, FieldRange{1, 30000});
  visit("distance_field_scans", config.distance_field_scans, FieldRange{1, 2});
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, an even kernel width, range limits that leave nothing, or a range or sigma of
/// too many voxels.
void check(const Config& config);

}  // namespace mosbench
