#pragma once

#include <memory>
#include <string>
#include <vector>

#include "eval/predictions/prediction_errors.hpp"
#include "eval/predictions/prediction_place.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {

/// Opens predictions in a file per scan, paired by stem or by position. Files without scan and
/// label files of the wrong size go to `errors`, what was recognised to `remarks`.
std::unique_ptr<Predictions> open_scan_files(const PredictionPlace& place, const Sequence& sequence,
                                             const std::vector<std::size_t>& wanted,
                                             const PredictionOptions& options,
                                             PredictionErrors& errors,
                                             std::vector<std::string>& remarks);

}  // namespace mosbench
