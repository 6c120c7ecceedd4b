#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/fields.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos_plus/block_history.hpp"
#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos_plus {

/// The settings of the paper's method that this one has, too: those of its map.
inline constexpr std::array<std::string_view, 10> kMapSettings = {
    "voxel_size_m",       "occupancy_sigma_m",   "min_range_m",         "max_range_m",
    "delay_scans",        "track_window_s",      "global_window_scans", "min_state_probability",
    "transition_epsilon", "distance_field_scans"};

/// Of the cube around a seed in which voxels should be known.
inline constexpr int kKnownRadius = 2;

/// The paper's map with distances to the current scan alone.
inline hmm_mos::Config paper_map() {
  hmm_mos::Config config;
  config.distance_field_scans = 1;
  return config;
}

/// Every parameter; docs/methods/hmm_mos_plus.md says what each is for.
struct Config {
  hmm_mos::Config map = paper_map();
  double seed_age_s = 1.5;
  double object_age_s = 2.0;
  double fresh_age_s = 0.2;
  double min_seed_share = 0.12;
  double max_aged_share = 0.5;
  double max_settled_share = 0.3;

  // No settings: nobody gains by other values on his own sensor.
  int max_unknown_voxels = 15;      ///< of the 125 voxels around a seed
  int max_gap_voxels = 3;           ///< unknown between known ones above and below: between beams
  int ground_radius_voxels = 2;     ///< the ground is the lowest voxel of the columns around
  int ground_layers_voxels = 1;     ///< so high above the ground voxels connect nothing
  int min_seeds_voxels = 3;         ///< of an object
  int min_pure_seeds_voxels = 2;    ///< of one that consists of seeds by half or more
  double min_fresh_share = 0.2;     ///< of an object's seeds: those of a parked car grow old
  double rise_radius_m = 6.0;       ///< of the ground around an object
  int min_rise_voxels = 2;          ///< above that, of a quarter of an object
  double max_growth_m = 3.0;        ///< from seeds, never through standing voxels
  double max_extent_m = 10.0;       ///< of an object, along x and y of the map
  double max_pure_extent_m = 20.0;  ///< of what consists of seeds: trucks
  double max_height_m = 4.5;        ///< of an object
  int min_track_steps = 1;          ///< before the next place is predicted; 0: never
};

/// The settings that it shares with the paper's method.
inline hmm_mos::Config& map_of(Config& config) { return config.map; }

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  hmm_mos::visit_fields(config.map, [&](std::string_view name, auto& field, const auto& legal,
                                        std::string_view meaning) {
    if (std::ranges::find(kMapSettings, name) != kMapSettings.end()) {
      visit(name, field, legal, meaning);
    }
  });
  constexpr double kMaxAge_s = BlockHistory::kMaxAgeTicks * TickClock::kSeconds;
  visit("seed_age_s", config.seed_age_s, FieldRange{0.0, kMaxAge_s},
        "a voxel that arrived in free space is a seed for so long; to tenths, by stamps or 10 Hz");
  visit("object_age_s", config.object_age_s, FieldRange{0.0, kMaxAge_s},
        "how long after its arrival a settled voxel still connects objects; an aged one belongs to "
        "an object for half as long; to tenths");
  visit("min_seed_share", config.min_seed_share, FieldRange{0.0, 1.0},
        "at least this share of an object's voxels are seeds");
  visit("fresh_age_s", config.fresh_age_s, FieldRange{0.0, kMaxAge_s},
        "a seed is fresh for so long; to tenths; from seed_age_s on every seed is");
  visit("max_aged_share", config.max_aged_share, FieldRange{0.0, 1.0},
        "at most this share of an object's voxels was seen occupied for 0.5 s or more, unless half "
        "or more are seeds");
  visit(
      "max_settled_share", config.max_settled_share, FieldRange{0.0, 1000.0},
      "settled voxels beside an object, per voxel of its own: with more it is part of what stands, "
      "unless four fifths of it arrived");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, and as hmm_mos::check does.
void check(const Config& config);

}  // namespace mosbench::hmm_mos_plus
