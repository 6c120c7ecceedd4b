#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/breakdown/error_scenes.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// Counted points by the step of the method that decided them.
struct ReasonCounts {
  std::uint64_t tp = 0, fp = 0, fn = 0;
  std::array<std::uint64_t, kErrorSceneNames.size()> scenes{};  ///< of fp and fn, by ErrorScene
};
/// By Reason; the last row has what a method moves that says no reasons.
using ReasonTable = std::array<ReasonCounts, kReasonCount + 1>;

/// Returns the counts of all scored scans; missed points have kNone. Returns the same for any
/// number of threads. Throws DataError.
ReasonTable count_reasons(const ResultScans& scans, unsigned threads);

nlohmann::ordered_json to_json(const ReasonTable& table);
Sheet reasons_sheet(const ReasonTable& table);

}  // namespace mosbench
