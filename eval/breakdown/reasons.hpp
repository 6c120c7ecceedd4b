#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// Counted points by the step of the method that decided them.
struct ReasonCounts {
  std::uint64_t tp = 0, fp = 0, fn = 0;
  std::uint64_t fp_in_view = 0;  ///< FP whose place was first hit within the last second
};
using ReasonTable = std::array<ReasonCounts, kReasonCount>;

/// Returns the counts of all scored scans by Reason; missed points have kNone. A place is a cell of
/// kPlaceCell_m of the map with its 26 neighbours. Throws DataError where the run kept no reasons.
ReasonTable count_reasons(const ResultScans& scans);
inline constexpr double kPlaceCell_m = 0.25;

nlohmann::ordered_json to_json(const ReasonTable& table);
Sheet reasons_sheet(const ReasonTable& table);

}  // namespace mosbench
