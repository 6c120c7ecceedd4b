#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <mosbench/settings.hpp>
#include <stdexcept>

#include "core/base/fields.hpp"
#include "core/tracks/whole_tracks.hpp"

namespace mosbench::tracks {

/// Throws std::invalid_argument for a window shorter than 1 s, or one beside a delay in scans.
inline void check_window(double window_s, int delay_scans) {
  if (window_s > 0 && window_s < 1) {
    throw std::invalid_argument("track_window_s: is less than 1 s, expected 0 or 1 to 3600");
  }
  if (window_s > 0 && delay_scans > 0) {
    throw std::invalid_argument("delay_scans: is set beside track_window_s, expected delay=" +
                                std::to_string(delay_scans) + ", which judges no whole tracks");
  }
}

/// Makes a method of a config by `make(config, context)`. If it asks for whole tracks, these are
/// judged by what the method calls moving with a delay of a second.
template <typename Config, typename Make>
std::unique_ptr<Method> make_by(const Settings& settings, const RunContext& context, Make&& make) {
  auto config = checked(config_of<Config>(settings));
  auto& map = map_of(config);
  if (map.track_window_s == 0) return make(config, context);
  const WholeTracksConfig whole{map.track_window_s, map.min_range_m, map.max_range_m};
  map.track_window_s = 0;
  map.delay_scans = static_cast<int>(ScanPeriod(context.stamps_ns).scans(kProposalDelay_s));
  RunContext proposing = context;
  proposing.scores = false;
  return std::make_unique<WholeTracks>(whole, make(config, proposing), context);
}

/// MethodKind::make of such a method, as mosbench::make_method of others.
template <typename Made, typename Config>
std::unique_ptr<Method> make_method(const Settings& settings, const RunContext& context) {
  return make_by<Config>(settings, context, [](const Config& config, const RunContext& in) {
    return std::make_unique<Made>(config, in);
  });
}

}  // namespace mosbench::tracks
