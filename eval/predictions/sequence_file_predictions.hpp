#pragma once

#include <memory>
#include <vector>

#include "eval/predictions/prediction_errors.hpp"
#include "eval/predictions/prediction_place.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {

/// Opens predictions of a whole sequence in one file: HMM-MOS's rows, indices.csv, Dynablox's
/// clouds.csv and scores.csv. Rows that match no scan go to `errors`. Throws DataError.
std::unique_ptr<Predictions> open_sequence_file(const PredictionPlace& place,
                                                const Sequence& sequence,
                                                const PredictionOptions& options,
                                                PredictionErrors& errors);

}  // namespace mosbench
