#pragma once

#include <memory>
#include <vector>

#include "eval/predictions/prediction_faults.hpp"
#include "eval/predictions/prediction_place.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {

/// Predictions of a whole sequence in one file: HMM-MOS's rows, indices.csv, Dynablox's clouds.csv
/// and scores.csv. Rows of no scan go to `faults`. Throws DataError.
std::unique_ptr<Predictions> open_sequence_file(const PredictionPlace& place,
                                                const Sequence& sequence,
                                                const PredictionOptions& options,
                                                PredictionFaults& faults);

}  // namespace mosbench
