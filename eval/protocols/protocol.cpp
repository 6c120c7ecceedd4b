#include "eval/protocols/protocol.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr auto kIgnored = TruthClass::kIgnored;
constexpr auto kStatic = TruthClass::kStatic;
constexpr auto kMoving = TruthClass::kMoving;

// The learning_map of semantic-kitti-mos.yaml. Ids outside it become class 0, as
// unlabelled points do, because the look-up table is filled with zeros; ids from 359 on crash the
// original program.
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

constexpr PrintStyle kPercent1{.percent = true, .digits = 1};
constexpr PrintStyle kPercent2{.percent = true, .digits = 2};
constexpr PrintStyle kPercent3{.percent = true, .digits = 3};
constexpr PrintStyle kSixSignificant{.percent = false, .digits = 6, .significant = true};

constexpr std::string_view kEvaluateMos = "PRBonn/semantic-kitti-api@a9c749e:evaluate_mos.py";
constexpr std::string_view kCalRecall = "hku-mars/M-detector@5ce002f:src/cal_recall_multi.cpp";
constexpr std::string_view kMapmosSource = "PRBonn/MapMOS@4092d93:src/mapmos/pipeline.py";

constexpr std::array kProtocols = {
    Protocol{.name = "doals-hmm",
             .summary = "mean of per-scan IoU; the range cuts the truth, not the prediction",
             .source = "vb44/HMM-MOS@ff47321:benchmarking/evaluation/src/evalIndFile.cpp",
             .truth = kAbove250,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthOnly,
             .default_range = {0.5, 20.0},
             .aggregation = Aggregation::kMeanOfScans,
             .program_print = kPercent2},
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
             .program_print = kPercent1},
    Protocol{.name = "semantickitti-mos",
             .summary = "pooled over all points; unlabelled and unknown truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .prediction = kSemanticKitti,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "valid"},
    Protocol{.name = "sipailou",
             .summary = "pooled over all points; unlabelled and unknown truth is static",
             .source = "xieKKKi/MotionBEV@233a348:config/livox-SEU-MOS.yaml",
             .truth = kSipailou,
             .prediction = kSipailou,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "test"},
    Protocol{.name = "helimos-all",
             .summary = "pooled per sensor over every labelled scan; unlabelled truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .prediction = kSemanticKitti,
             .aggregation = Aggregation::kMeanOfSequences,
             .empty_case = EmptyCase::kEpsilon},
    Protocol{.name = "helimos-test",
             .summary = "pooled per sensor over the scans of test.txt; unlabelled truth is ignored",
             .source = kEvaluateMos,
             .truth = kSemanticKitti,
             .prediction = kSemanticKitti,
             .aggregation = Aggregation::kMeanOfSequences,
             .empty_case = EmptyCase::kEpsilon,
             .default_split = "test"},
    Protocol{.name = "mapmos",
             .summary = "pooled; truth ids 0 and 1 ignored, above 250 moving, all between static",
             .source = kMapmosSource,
             .truth = kMapmosHelimos,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .empty_case = EmptyCase::kNanWithoutTruth,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kPercent3,
             .default_split = "test"},
    Protocol{.name = "mapmos-apollo",
             .summary = "pooled; nothing ignored: truth ids up to 250 static, above moving",
             .source = "PRBonn/MapMOS@4092d93:src/mapmos/datasets/apollo.py",
             .truth = kAbove250,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .empty_case = EmptyCase::kNanWithoutTruth,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kPercent3},
    Protocol{.name = "mapmos-kitti-tracking",
             .summary = "pooled; truth ids 0 to 2 ignored, above 250 moving, all between static",
             .source = "PRBonn/MapMOS@4092d93:src/mapmos/datasets/kitti_tracking.py",
             .truth = kMapmosTracking,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .empty_case = EmptyCase::kNanWithoutTruth,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kPercent3},
    Protocol{.name = "mapmos-nuscenes",
             .summary = "pooled; as mapmos, all scans with boxes",
             .source = kMapmosSource,
             .truth = kMapmosHelimos,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .default_range = {3.0, -1.0},
             .empty_case = EmptyCase::kNanWithoutTruth,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kPercent3},
    Protocol{.name = "moe",
             .summary = "pooled per sequence, mean of sequences; nothing is ignored",
             .source = "DeepDuke/MOE-Dataset:README.md",
             .truth = kAbove250,
             .prediction = kAbove250,
             .aggregation = Aggregation::kMeanOfSequences},
    Protocol{.name = "mdetector",
             .summary = "pooled per sequence; ids from 251 moving, 65535 ignored",
             .source = kCalRecall,
             .truth = kMdetector,
             .prediction = kMdetector,
             .aggregation = Aggregation::kMeanOfSequences,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kSixSignificant},
    Protocol{.name = "mdetector-nuscenes",
             .summary = "as mdetector, but truth ids 251 to 999 are always true negatives",
             .source = kCalRecall,
             .truth = kMdetectorNuscenes,
             .prediction = kMdetector,
             .aggregation = Aggregation::kMeanOfSequences,
             .metric_arithmetic = Arithmetic::kFloat,
             .program_print = kSixSignificant},
    Protocol{.name = "sceneflow-dynamic",
             .summary = "mean of per-scan dynamic IoU where the flow is valid: within eval_mask, "
                        "without one off the ground at any range",
             .source = "KTH-RPL/OpenSceneFlow@2a9c474:src/utils/av2_eval.py",
             .truth = kSceneFlow,
             .prediction = kAbove250,
             .range_rule = RangeRule::kTruthAndPrediction,
             .aggregation = Aggregation::kMeanOfScans,
             .empty_case = EmptyCase::kEpsilon,
             .program_print = kSixSignificant,
             .default_split = "eval"},
};

}  // namespace

std::span<const Protocol> protocols() { return kProtocols; }

const Protocol* find_protocol(std::string_view name) {
  const auto found = std::ranges::find(kProtocols, name, &Protocol::name);
  return found == kProtocols.end() ? nullptr : &*found;
}

const Protocol& protocol_named(std::string_view name) {
  if (const Protocol* protocol = find_protocol(name)) return *protocol;
  std::vector<std::string_view> names;
  for (const Protocol& protocol : kProtocols) names.push_back(protocol.name);
  throw UsageError("protocol: \"" + std::string(name) + "\" does not exist, expected a name that " +
                   "`mosbench list` shows, such as \"" + std::string(nearest_name(name, names)) +
                   "\"");
}

}  // namespace mosbench
