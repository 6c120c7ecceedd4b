#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "eval/protocols/label_map.hpp"

namespace mosbench {

/// How a point outside the range limits is counted.
enum class RangeRule : std::uint8_t {
  kNone,               ///< there are no limits; the points' coordinates are not needed
  kTruthOnly,          ///< its truth becomes static; a moving prediction there is a false positive
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

/// How the counts of many scans are combined into one number.
enum class Aggregation : std::uint8_t {
  kPooled,          ///< metric of the summed counts of all scans, whatever their sequence
  kMeanOfScans,     ///< mean of the scans' metrics
  kMeanOfSequences  ///< pooled within a sequence; the average is the plain mean of the sequences
};

/// What the protocol's own program returns where the moving IoU is 0/0.
enum class EmptyCase : std::uint8_t {
  kNan,              ///< 0/0
  kNanWithoutTruth,  ///< NaN whenever no truth point moves, even with false positives
  kOne,              ///< a perfect score
  kEpsilon           ///< 0: the denominator is enlarged by 1e-15
};

/// The number type in which the protocol's own program computes.
enum class Arithmetic : std::uint8_t { kDouble, kFloat };

/// How a fraction 0..1 is printed: as a fraction or in percent, with a number of decimals or of
/// significant digits.
struct PrintStyle {
  bool percent = false;
  int digits = 3;
  bool significant = false;
};

/// The rules of one benchmark. A protocol is a row of data: no other code asks which protocol it
/// has. What a row does not say is as most benchmarks have it.
struct Protocol {
  std::string_view name;
  std::string_view summary;  ///< how it differs from the others, one line
  std::string_view source;   ///< owner/repository@commit:path of the program it reproduces
  IdMap truth;
  IdMap prediction;  ///< kMoving is a moving prediction, every other class a static one
  RangeRule range_rule = RangeRule::kNone;
  RangeGate default_range = {0.0, -1.0};  ///< no limits
  Arithmetic range_arithmetic = Arithmetic::kDouble;
  Aggregation aggregation = Aggregation::kPooled;
  EmptyCase empty_case = EmptyCase::kNan;
  Arithmetic metric_arithmetic = Arithmetic::kDouble;
  int file_significant_digits = 0;  ///< of the scan values that its program averages; 0: all digits
  PrintStyle program_print = {};    ///< of its own program
  /// Of the data set it is published for; empty: all labelled scans.
  std::string_view default_split = "";
};

/// A protocol with the range it is applied over.
struct ScoreRule {
  const Protocol* protocol;
  RangeGate range;

  bool operator==(const ScoreRule&) const = default;
};

/// All protocols in the order in which they are listed.
std::span<const Protocol> protocols();

/// Returns null when no protocol has this name.
const Protocol* find_protocol(std::string_view name);

/// Returns the protocol of this name. Throws UsageError naming the nearest one if there is none.
const Protocol& protocol_named(std::string_view name);

}  // namespace mosbench
