#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/engine/score_execute.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {

/// Returns a remark when labels fit the truth clearly better up to 10 scans earlier or later, as
/// when a method numbers them by the newest scan that it has seen; else empty. Compares a dozen of
/// `scans` with the labels around them; those of scans with another number of points are passed
/// over. Throws DataError.
std::string shift_remark(const Sequence& sequence, const std::vector<std::size_t>& scans,
                         const Predictions& labels, const ScoreRule& rule);

}  // namespace mosbench
