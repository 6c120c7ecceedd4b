#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "eval/protocols/label_map.hpp"

namespace mosbench {

/// What a point outside the range limits means.
enum class RangeRule : std::uint8_t {
  kNone,       ///< there are no limits; the points of a scan are not needed
  kTruthOnly,  ///< its truth is not moving, yet a moving prediction there is a false positive
  kTruthAndPrediction  ///< it is ignored
};

/// Distances from the sensor that count, both ends inclusive, metres.
struct RangeGate {
  double min_m = 0.5;
  double max_m = 20.0;  ///< no upper limit when zero or negative, as MapMOS writes it

  /// A NaN range is outside. An infinite one is inside only without an upper limit.
  bool contains(double range_m) const {
    return range_m >= min_m && (max_m <= 0.0 || range_m <= max_m);
  }
  bool operator==(const RangeGate&) const = default;
};

/// How counts of many scans become one number.
enum class Aggregation : std::uint8_t {
  kPooled,          ///< metric of the summed counts of all scans, whatever their sequence
  kMeanOfScans,     ///< mean of the scans' metrics
  kMeanOfSequences  ///< pooled within a sequence; the average is the plain mean of the sequences
};

/// What the protocol's own program gives where the moving IoU has no value.
enum class EmptyCase : std::uint8_t {
  kNan,              ///< 0/0
  kNanWithoutTruth,  ///< NaN as soon as no truth point moves, also with false positives
  kOne,              ///< a perfect score
  kEpsilon           ///< 0: the denominator is enlarged by 1e-15
};

/// The number type in which the protocol's own program computes.
enum class Arithmetic : std::uint8_t { kDouble, kFloat };

/// How a fraction 0..1 is printed: as it is or in percent, with so many decimals or significant
/// digits.
struct PrintStyle {
  bool percent = false;
  int digits = 3;
  bool significant = false;
};

/// The rules of one benchmark. A protocol is a row of data: nothing else in the program asks which
/// protocol it is dealing with.
struct Protocol {
  std::string_view name;
  std::string_view summary;  ///< what sets it apart, one line
  std::string_view source;   ///< owner/repository@commit:path of the program it reproduces
  IdMap truth;
  IdMap prediction;  ///< kMoving is a moving prediction, every other class is none
  RangeRule range_rule;
  RangeGate default_range;
  Arithmetic range_arithmetic;
  Aggregation aggregation;
  EmptyCase empty_case;
  Arithmetic metric_arithmetic;
  PrintStyle print;             ///< of its published tables
  int file_significant_digits;  ///< of the scans' values its program averages; 0: all digits
  PrintStyle program_print;     ///< of its own program
  std::string_view
      default_split;  ///< of the data set it is published for; empty: all labelled scans
};

/// All protocols in the order in which they are listed.
std::span<const Protocol> protocols();

/// Nothing when no protocol has this name.
const Protocol* find_protocol(std::string_view name);

/// The protocol of this name. Throws UsageError naming the nearest one otherwise.
const Protocol& protocol_named(std::string_view name);

}  // namespace mosbench
