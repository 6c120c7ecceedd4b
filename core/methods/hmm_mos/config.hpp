#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/base/fields.hpp"

namespace mosbench::hmm_mos {

/// Which of the authors' two programs is reproduced. release-2025, the later one, has no delay and
/// no dynamic region, removes voxels from the map at 1.5 instead of 2 times the range limit, and
/// never removes those last seen in the first w_g scans.
enum class Variant { kPaper2024, kRelease2025 };
inline constexpr std::array<std::string_view, 2> kVariantNames = {"paper-2024", "release-2025"};

/// Every parameter of the method, with the paper's symbol (III); the defaults are the paper's for
/// DOALS at 20 m.
struct Config {
  Variant variant = Variant::kPaper2024;
  double voxel_size_m = 0.20;               ///< Delta
  std::optional<double> occupancy_sigma_m;  ///< sigma_o; the voxel size when not set
  double min_range_m = 0.5;                 ///< points at or nearer than this never take part
  double max_range_m = 20.0;                ///< voxels farther than this are not observed
  int delay_scans = 0;                      ///< n; 0 is online, as release-2025 always is
  double track_window_s = 0;                ///< of whole tracks; 0: points are judged by their past
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

/// The settings of the map, of which it is a part in other methods.
inline Config& map_of(Config& config) { return config; }

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("variant", config.variant, kVariantNames,
        "the authors' program of the paper's tables, or their later one");
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0}, "Delta, edge of a voxel");
  visit("occupancy_sigma_m", config.occupancy_sigma_m, FieldRange{0.001, 100.0, "voxel_size_m"},
        "sigma_o of the occupancy likelihood");
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never move");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "voxels farther than this are not observed");
  visit("delay_scans", config.delay_scans, FieldRange{0, 1000},
        "n, labels are decided this many scans later; 0 is online");
  visit("track_window_s", config.track_window_s, FieldRange{0.0, 3600.0},
        "whole object tracks are judged, labels come up to this much later; 0: not; stands for "
        "delay_scans, --set delay=all");
  visit("local_window_scans", config.local_window_scans, FieldRange{1, 1000},
        "w_l, scans whose votes are added up");
  visit("global_window_scans", config.global_window_scans, FieldRange{1, 30000},
        "w_g, scans after which an unobserved voxel is forgotten");
  visit("kernel_width_voxels", config.kernel_width_voxels, FieldRange{1, 15},
        "m, width of the spatial filter, odd");
  visit("min_state_probability", config.min_state_probability, FieldRange{0.5, 0.999999},
        "p_min, a voxel takes a state above this probability");
  visit("min_otsu_score", config.min_otsu_score, FieldRange{0, 1000000},
        "otsu_min, a scan has moving points only if its threshold exceeds this");
  visit("transition_epsilon", config.transition_epsilon, FieldRange{1e-6, 0.499},
        "epsilon of the transition matrix");
  visit("dynamic_window_scans", config.dynamic_window_scans, FieldRange{1, 30000},
        "w_d, scans that a moving voxel is remembered; paper-2024 only");
  visit("distance_field_scans", config.distance_field_scans, FieldRange{1, 2},
        "distances to this scan and the one before (2, the program) or to this one (1, the paper)");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, an even kernel width, range limits that leave nothing, a range or sigma of
/// too many voxels, a window of tracks below 1 s or beside a delay, and either in release-2025.
void check(const Config& config);

}  // namespace mosbench::hmm_mos
