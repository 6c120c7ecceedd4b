#pragma once

#include <nlohmann/json.hpp>

#include "eval/result/result_scans.hpp"
#include "eval/truth/track_list.hpp"

namespace mosbench {

/// Returns a track with what is around it as a film from above, in whole centimetres of the map
/// from the middle of its way: {"half_cm", "frames": [{"scan", "track": [x, y, ...], "around"}]}.
/// Long tracks have every so many scans. Throws DataError.
nlohmann::ordered_json film_of(const ResultScans& scans, const TruthTrack& track);

}  // namespace mosbench
