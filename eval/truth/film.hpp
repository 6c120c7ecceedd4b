#pragma once

#include <nlohmann/json.hpp>

#include "eval/truth/truth_scan.hpp"

namespace mosbench {

/// Returns a track with what is around it as a film, in whole centimetres of the map from
/// `middle_m`, the middle of its way: {"middle_m", "half_cm", "frames": [{"scan", "track": [x, y,
/// z, ...], "around", "others": {"12": [...]}}]}; `others` are tracks, too. Shows `wider` times as
/// much, in space and before and after. Long tracks have every so many scans. Throws DataError.
nlohmann::ordered_json film_of(const ResultScans& scans, std::span<const MadeTrack> made,
                               const TruthTrack& track, std::size_t wider);

}  // namespace mosbench
