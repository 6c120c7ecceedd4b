#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// How a point's truth is counted.
enum class TruthClass : std::uint8_t {
  kIgnored,        ///< not counted at all
  kStatic,         ///< true negative or false positive
  kMoving,         ///< true positive or false negative
  kAlwaysNegative  ///< a true negative whatever is predicted (M-detector on nuScenes, ids 251..999)
};

/// Label ids first..last, both inclusive, belong to one class.
struct IdRange {
  std::uint16_t first, last;
  TruthClass becomes;
};

/// Maps label ids to classes. The lower 16 bits of a label are its id, the upper 16 an instance
/// number.
struct IdMap {
  std::span<const IdRange> ranges;  ///< where two overlap, the later one applies
  TruthClass unknown;               ///< class of the ids in no range; they are counted as unknown
};

/// An IdMap expanded to all 65536 ids, so that each point costs one look-up.
class LabelTable {
 public:
  explicit LabelTable(const IdMap& map);

  TruthClass operator[](std::uint32_t label) const {
    return static_cast<TruthClass>(entries_[label & 0xFFFFU] & ~kUnknown);
  }
  bool is_known(std::uint32_t label) const { return (entries_[label & 0xFFFFU] & kUnknown) == 0; }

 private:
  static constexpr std::uint8_t kUnknown = 0x80;
  std::array<std::uint8_t, 65536> entries_;
};

/// How a point outside the range limits is counted.
enum class RangeRule : std::uint8_t {
  kNone,               ///< there are no limits; the points' coordinates are not needed
  kTruthOnly,          ///< its truth becomes static; a moving prediction there is a false positive
  kTruthAndPrediction  ///< it is ignored
};

/// What the range limits are for.
enum class RangeShape : std::uint8_t {
  kDistance,  ///< from the sensor
  kBox        ///< the larger of |x| and |y|
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
inline constexpr RangeGate kNoLimits = {0.0, -1.0};

/// Returns "0.5 to 20 m" or "from 0.5 m".
std::string gate_text(const RangeGate& range);

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
  kEpsilon           ///< 0: the denominator is enlarged by Protocol::epsilon
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
  int stops_at_id = 0;  ///< from which id on its program stops; 0: at none
  IdMap prediction;     ///< kMoving is a moving prediction, every other class a static one
  bool counts_known_predictions_only = false;  ///< kIgnored leaves a point out
  std::size_t min_points = 0;                  ///< a scan of fewer counts nowhere
  RangeRule range_rule = RangeRule::kNone;
  RangeShape range_shape = RangeShape::kDistance;
  RangeGate default_range = kNoLimits;
  Arithmetic range_arithmetic = Arithmetic::kDouble;
  Aggregation aggregation = Aggregation::kPooled;
  EmptyCase empty_case = EmptyCase::kNan;
  double epsilon = 1e-15;  ///< of EmptyCase::kEpsilon
  Arithmetic metric_arithmetic = Arithmetic::kDouble;
  int file_significant_digits = 0;  ///< of the scan values that its program averages; 0: all digits
  PrintStyle program_print = {};    ///< of its own program
  /// Of the data set it is published for; empty: all labelled scans.
  std::string_view default_split = "";
  /// The protocol that counts every scan in the same way, over its own default split alone.
  std::string_view within_split = "";
  bool has_dynablox_counts = false;  ///< scores.csv of Dynablox holds its counts
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

/// A protocol in words, one member per line of `mosbench list protocols`.
struct ProtocolDescription {
  std::string name;
  std::string truth;        ///< "0-1 ignored, 9 static, 251-259 moving, others ignored"
  std::string prediction;   ///< ids that count as a moving prediction
  std::string range;        ///< "truth and prediction, 0.5 to 20 m"
  std::string aggregation;  ///< "mean of scans"
  std::string split;        ///< scans its published numbers are over: "test", "all labelled scans"
  std::string empty_case;   ///< what its own program gives for 0/0
  std::string summary;
  std::string source;
};

/// All protocols, in the order of `protocols()`.
std::vector<ProtocolDescription> describe_protocols();

/// Returns the range of the points that count; empty when the protocol does not limit it.
std::string counted_range_text(const Protocol& protocol, const RangeGate& range);

/// Returns what is to be said of points whose ids the protocol does not list; empty without any.
std::string unknown_ids_remark(const Protocol& protocol, std::uint64_t points);

/// Returns "protocol mapmos: pooled; ... (from 3 m)", the range that is really applied.
std::string rule_line(const ScoreRule& rule);
/// Returns "mapmos (from 3 m)".
std::string rule_name(const ScoreRule& rule);

}  // namespace mosbench
