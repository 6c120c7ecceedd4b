#pragma once

#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Whether a sensor whose poses are not known stands still.
struct StillSensor {
  bool stands = false;
  std::string said;  ///< how that was found, or why it cannot be told; empty where it moves
};

/// Registers up to 40 scans of the whole sequence to the first one, as if the sensor stood. It
/// stands where all stay within some centimetres although their surfaces hold them in every
/// direction: a corridor does not. Scans are read until one has moved, the last of all first.
/// Throws DataError.
StillSensor find_still_sensor(const Sequence& sequence);

}  // namespace mosbench
