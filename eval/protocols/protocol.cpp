#include "eval/protocols/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr auto kIgnored = TruthClass::kIgnored;
constexpr auto kStatic = TruthClass::kStatic;
constexpr auto kMoving = TruthClass::kMoving;

// The learning_map of semantic-kitti-mos.yaml. Ids outside it become class 0, as
// unlabelled points do, because the look-up table is filled with zeros; it ends 100 ids behind the
// last listed one.
constexpr std::array kSemanticKittiIds = {
    IdRange{0, 1, kIgnored},  IdRange{9, 11, kStatic},  IdRange{13, 13, kStatic},
    IdRange{15, 16, kStatic}, IdRange{18, 18, kStatic}, IdRange{20, 20, kStatic},
    IdRange{30, 32, kStatic}, IdRange{40, 40, kStatic}, IdRange{44, 44, kStatic},
    IdRange{48, 52, kStatic}, IdRange{60, 60, kStatic}, IdRange{70, 72, kStatic},
    IdRange{80, 81, kStatic}, IdRange{99, 99, kStatic}, IdRange{251, 259, kMoving}};
constexpr IdMap kSemanticKitti{kSemanticKittiIds, kIgnored};

// livox-SEU-MOS.yaml: class 0 is static there, so unlabelled and unknown ids are static truth.
constexpr std::array kSipailouIds = {IdRange{0, 0, kStatic}, IdRange{9, 9, kStatic},
                                     IdRange{251, 252, kMoving}};
constexpr IdMap kSipailou{kSipailouIds, kStatic};

// DOALS lists moving points only: the reader hands them over as 251, all others as static.
constexpr std::array kAbove250Ids = {IdRange{0, 250, kStatic}, IdRange{251, 65535, kMoving}};
constexpr IdMap kAbove250{kAbove250Ids, kStatic};

constexpr std::array kHelimosIds = {IdRange{0, 1, kIgnored}, IdRange{2, 250, kStatic},
                                    IdRange{251, 65535, kMoving}};
constexpr IdMap kMapmosHelimos{kHelimosIds, kStatic};

constexpr std::array kTrackingIds = {IdRange{0, 2, kIgnored}, IdRange{3, 250, kStatic},
                                     IdRange{251, 65535, kMoving}};
constexpr IdMap kMapmosTracking{kTrackingIds, kStatic};

constexpr std::array kMdetectorIds = {IdRange{0, 250, kStatic}, IdRange{251, 65534, kMoving},
                                      IdRange{65535, 65535, kIgnored}};
constexpr IdMap kMdetector{kMdetectorIds, kStatic};

constexpr std::array kMdetectorMovingIds = {IdRange{0, 250, kStatic}, IdRange{251, 65534, kMoving},
                                            IdRange{65535, 65535, kStatic}};
constexpr IdMap kMdetectorMoving{kMdetectorMovingIds, kStatic};

// KITTI's and Avia's scorers count a miss, and a true negative, where the prediction is 9.
constexpr std::array kMovingOr9Ids = {IdRange{9, 9, kStatic}, IdRange{251, 65534, kMoving}};
constexpr IdMap kMovingOr9{kMovingOr9Ids, kIgnored};

constexpr std::array kNuscenesIds = {
    IdRange{0, 250, kStatic}, IdRange{251, 999, TruthClass::kAlwaysNegative},
    IdRange{1000, 65534, kMoving}, IdRange{65535, 65535, kIgnored}};
constexpr IdMap kMdetectorNuscenes{kNuscenesIds, kStatic};

// The reader of OpenSceneFlow gives 0 where the flow is not valid, 40, 99 and 259 where the
// benchmark does not look.
constexpr std::array kSceneFlowIds = {
    IdRange{0, 0, kIgnored},    IdRange{1, 39, kStatic},     IdRange{40, 40, kIgnored},
    IdRange{41, 98, kStatic},   IdRange{99, 99, kIgnored},   IdRange{100, 250, kStatic},
    IdRange{251, 258, kMoving}, IdRange{259, 259, kIgnored}, IdRange{260, 65535, kMoving}};
constexpr IdMap kSceneFlow{kSceneFlowIds, kStatic};

constexpr PrintStyle kSixSignificant{.percent = false, .digits = 6, .significant = true};

constexpr std::string_view kEvaluateMos = "PRBonn/semantic-kitti-api@a9c749e:evaluate_mos.py";
constexpr std::string_view kCalRecall = "hku-mars/M-detector@5ce002f:src/cal_recall_multi.cpp";
constexpr std::string_view kMapmosSource = "PRBonn/MapMOS@4092d93:src/mapmos/pipeline.py";
constexpr std::string_view kAv2Eval = "KTH-RPL/OpenSceneFlow@2a9c474:src/utils/av2_eval.py";

/// The program of MapMOS, which skips points out of range, on one of its data sets.
constexpr Protocol of_mapmos(std::string_view name, std::string_view summary,
                             std::string_view source, const IdMap& truth,
                             std::string_view default_split = "", RangeGate range = kNoLimits) {
  return {.name = name,
          .summary = summary,
          .source = source,
          .truth = truth,
          .prediction = kAbove250,
          .range_rule = RangeRule::kTruthAndPrediction,
          .default_range = range,
          .empty_case = EmptyCase::kNanWithoutTruth,
          .metric_arithmetic = Arithmetic::kFloat,
          .program_print = {.percent = true, .digits = 3},
          .default_split = default_split};
}

/// The scorers of M-detector, one per data set in the same file.
constexpr Protocol of_mdetector(std::string_view name, std::string_view summary, const IdMap& truth,
                                const IdMap& prediction, std::size_t min_points = 0) {
  return {.name = name,
          .summary = summary,
          .source = kCalRecall,
          .truth = truth,
          .prediction = prediction,
          .counts_known_predictions_only = true,
          .min_points = min_points,
          .aggregation = Aggregation::kMeanOfSequences,
          .metric_arithmetic = Arithmetic::kFloat,
          .program_print = kSixSignificant};
}

constexpr Protocol of_scene_flow(std::string_view name, std::string_view summary, RangeShape shape,
                                 RangeGate range) {
  return {.name = name,
          .summary = summary,
          .source = kAv2Eval,
          .truth = kSceneFlow,
          .prediction = kAbove250,
          .range_rule = RangeRule::kTruthAndPrediction,
          .range_shape = shape,
          .default_range = range,
          .aggregation = Aggregation::kMeanOfScans,
          .empty_case = EmptyCase::kEpsilon,
          .epsilon = 1e-6,
          .program_print = kSixSignificant,
          .default_split = "eval"};
}

constexpr std::array kProtocols = {
    Protocol{.name = "doals-hmm",
             .summary = "mean of per-scan IoU; the range cuts the truth, not the prediction",
             .source = "vb44/HMM-MOS@ff47321:benchmarking/evaluation/src/evalIndFile.cpp",
             .truth = kAbove250,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthOnly,
             .default_range = {0.5, 20.0},
             .aggregation = Aggregation::kMeanOfScans,
             .program_print = {.percent = true, .digits = 2}},
    Protocol{.name = "doals-dynablox",
             .summary = "mean of per-scan IoU; the range cuts truth and prediction",
             .source = "ethz-asl/dynablox@58d8a59:dynablox/src/evaluation/evaluator.cpp",
             .truth = kAbove250,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .default_range = {0.5, 20.0},
             .range_arithmetic = Arithmetic::kFloat,
             .aggregation = Aggregation::kMeanOfScans,
             .empty_case = EmptyCase::kOne,
             .metric_arithmetic = Arithmetic::kFloat,
             .file_significant_digits = 6,
             .program_print = {.percent = true, .digits = 1},
             .has_dynablox_counts = true},
    Protocol{.name = "semantickitti-mos",
             .summary = "pooled over all points; unlabelled and unknown truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .stops_at_id = 359,
             .prediction = kSemanticKitti,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "valid"},
    Protocol{.name = "sipailou",
             .summary = "pooled over all points; unlabelled and unknown truth is static",
             .source = "xieKKKi/MotionBEV@233a348:config/livox-SEU-MOS.yaml",
             .truth = kSipailou,
             .stops_at_id = 352,
             .prediction = kSipailou,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "test"},
    Protocol{.name = "helimos-all",
             .summary = "pooled per sensor over every labelled scan; unlabelled truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .stops_at_id = 359,
             .prediction = kSemanticKitti,
             .aggregation = Aggregation::kMeanOfSequences,
             .empty_case = EmptyCase::kEpsilon,
             .within_split = "helimos-test"},
    Protocol{.name = "helimos-test",
             .summary = "pooled per sensor over the scans of test.txt; unlabelled truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .stops_at_id = 359,
             .prediction = kSemanticKitti,
             .aggregation = Aggregation::kMeanOfSequences,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "test"},
    of_mapmos("mapmos", "pooled; truth ids 0 and 1 ignored, above 250 moving, all between static",
              "PRBonn/MapMOS@3c627f0:src/mapmos/pipeline.py", kMapmosHelimos, "test"),
    of_mapmos("mapmos-apollo", "pooled; nothing ignored: truth ids up to 250 static, above moving",
              "PRBonn/MapMOS@4092d93:src/mapmos/datasets/apollo.py", kAbove250),
    of_mapmos("mapmos-kitti-tracking",
              "pooled; truth ids 0 to 2 ignored, above 250 moving, all between static",
              "PRBonn/MapMOS@4092d93:src/mapmos/datasets/kitti_tracking.py", kMapmosTracking),
    of_mapmos("mapmos-nuscenes", "pooled; as mapmos, all scans with boxes", kMapmosSource,
              kMapmosHelimos, "", {3.0, -1.0}),
    Protocol{.name = "moe",
             .summary = "pooled per sequence, mean of sequences; nothing is ignored",
             .source = "DeepDuke/MOE-Dataset:README.md",
             .truth = kAbove250,
             .prediction = kAbove250,
             .aggregation = Aggregation::kMeanOfSequences},
    of_mdetector("mdetector", "pooled per sequence; ids from 251 moving, 65535 ignored", kMdetector,
                 kMdetectorMoving),
    of_mdetector("mdetector-kitti",
                 "as mdetector, but points whose prediction is neither moving nor 9 do not count",
                 kMdetector, kMovingOr9),
    of_mdetector("mdetector-nuscenes",
                 "as mdetector, but truth ids 251 to 999 are always true negatives",
                 kMdetectorNuscenes, kMdetectorMoving, 2),
    of_scene_flow("sceneflow-dynamic",
                  "mean of per-scan dynamic IoU of the points off the ground where the flow is "
                  "valid, within eval_mask",
                  RangeShape::kBox, {0.0, 35.0}),
    of_scene_flow("sceneflow-dynamic-far", "as sceneflow-dynamic, at any distance",
                  RangeShape::kDistance, kNoLimits),
};

// In the order of TruthClass, of Aggregation and of EmptyCase.
constexpr std::array<std::string_view, 4> kClassWords = {"ignored", "static", "moving",
                                                         "always a true negative"};
constexpr std::array<std::string_view, 3> kAggregationWords = {
    "pooled", "mean of scans", "pooled per sequence, mean of sequences"};
constexpr std::array<std::string_view, 4> kEmptyWords = {"NaN", "NaN without moving truth", "1",
                                                         "0"};

template <typename Words, typename Value>
std::string word(const Words& words, Value value) {
  return std::string(words[static_cast<std::size_t>(value)]);
}

std::string ids_text(const IdRange& range) {
  return range.first == range.last ? fmt::format("{}", range.first)
                                   : fmt::format("{}-{}", range.first, range.last);
}

/// "0-1 9 20": the ids of one class.
std::string ids_of(const IdMap& map, TruthClass wanted) {
  std::string text;
  for (const IdRange& range : map.ranges) {
    if (range.becomes != wanted) continue;
    if (!text.empty()) text += ' ';
    text += ids_text(range);
  }
  return text;
}

bool knows_every_id(const IdMap& map) {
  const LabelTable table(map);
  for (std::uint32_t id = 0; id <= 0xFFFF; ++id) {
    if (!table.is_known(id)) return false;
  }
  return true;
}

std::string describe_truth(const IdMap& map) {
  std::string text;
  for (const TruthClass wanted : {TruthClass::kIgnored, TruthClass::kStatic, TruthClass::kMoving,
                                  TruthClass::kAlwaysNegative}) {
    const std::string listed = ids_of(map, wanted);
    if (!listed.empty()) text += fmt::format("{} {}, ", listed, word(kClassWords, wanted));
  }
  if (!knows_every_id(map)) return text + fmt::format("others {}", word(kClassWords, map.unknown));
  return text.substr(0, text.size() - 2);
}

std::string describe_range(const Protocol& protocol) {
  if (protocol.range_rule == RangeRule::kNone) return "none";
  const std::string_view what =
      protocol.range_rule == RangeRule::kTruthOnly ? "truth only" : "truth and prediction";
  const RangeGate& range = protocol.default_range;
  return fmt::format("{}, {} by default", what,
                     range == kNoLimits ? "no limit" : counted_range_text(protocol, range));
}

std::string in_brackets(const ScoreRule& rule) {
  const std::string range = counted_range_text(*rule.protocol, rule.range);
  return range.empty() ? "" : fmt::format(" ({})", range);
}

}  // namespace

LabelTable::LabelTable(const IdMap& map) {
  entries_.fill(static_cast<std::uint8_t>(static_cast<std::uint8_t>(map.unknown) | kUnknown));
  for (const IdRange& range : map.ranges) {
    std::fill(entries_.begin() + range.first, entries_.begin() + range.last + 1,
              static_cast<std::uint8_t>(range.becomes));
  }
}

std::span<const Protocol> protocols() { return kProtocols; }

const Protocol* find_protocol(std::string_view name) {
  const auto found = std::ranges::find(kProtocols, name, &Protocol::name);
  return found == kProtocols.end() ? nullptr : &*found;
}

const Protocol& protocol_named(std::string_view name) {
  if (const Protocol* protocol = find_protocol(name)) return *protocol;
  std::vector<std::string_view> names;
  for (const Protocol& protocol : kProtocols) names.push_back(protocol.name);
  throw UsageError(fmt::format(
      "protocol: \"{}\" does not exist, expected a name that `mosbench list` shows, such as \"{}\"",
      name, nearest_name(name, names)));
}

std::string gate_text(const RangeGate& range) {
  return range.max_m > 0.0 ? fmt::format("{:g} to {:g} m", range.min_m, range.max_m)
                           : fmt::format("from {:g} m", range.min_m);
}

std::vector<ProtocolDescription> describe_protocols() {
  std::vector<ProtocolDescription> rows;
  for (const Protocol& protocol : protocols()) {
    rows.push_back({.name = std::string(protocol.name),
                    .truth = describe_truth(protocol.truth),
                    .prediction = ids_of(protocol.prediction, TruthClass::kMoving),
                    .range = describe_range(protocol),
                    .aggregation = word(kAggregationWords, protocol.aggregation),
                    .split = protocol.default_split.empty() ? "all labelled scans"
                                                            : std::string(protocol.default_split),
                    .empty_case = word(kEmptyWords, protocol.empty_case),
                    .summary = std::string(protocol.summary),
                    .source = std::string(protocol.source)});
  }
  return rows;
}

std::string counted_range_text(const Protocol& protocol, const RangeGate& range) {
  if (protocol.range_rule == RangeRule::kNone) return "";
  return gate_text(range) + (protocol.range_shape == RangeShape::kBox ? " in x and y" : "");
}

std::string unknown_ids_remark(const Protocol& protocol, std::uint64_t points) {
  if (points == 0) return "";
  return fmt::format(
      "{} a label id that protocol {} does not know: counted as it says{}",
      counted(points, "point has", "points have"), protocol.name,
      protocol.stops_at_id == 0
          ? ""
          : fmt::format(", while its own program stops at ids from {} on", protocol.stops_at_id));
}

std::string rule_line(const ScoreRule& rule) {
  return fmt::format("protocol {}: {}{}", rule.protocol->name, rule.protocol->summary,
                     in_brackets(rule));
}

std::string rule_name(const ScoreRule& rule) {
  return std::string(rule.protocol->name) + in_brackets(rule);
}

}  // namespace mosbench
