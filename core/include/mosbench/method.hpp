#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mosbench/scan.hpp>
#include <mosbench/settings.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// One run of a stage of a method.
struct StageTime {
  std::string_view name;                        ///< of static storage
  std::chrono::steady_clock::time_point start;  ///< when it began
  double wall_ms = 0;                           ///< from start to end
  double cpu_ms = 0;  ///< of the whole process, all threads; 0 unless RunContext::cpu_times
};

/// Why a method calls a point moving.
enum class Reason : std::uint8_t {
  kNone,       ///< it does not
  kArrived,    ///< its place was free before
  kDeparted,   ///< its place is free afterwards
  kGrown,      ///< it is connected with such points
  kFeet,       ///< it is next to the ground, below such points
  kPredicted,  ///< what moved before should be at its place
};
/// Number of values of Reason.
inline constexpr std::size_t kReasonCount = 6;

/// One scan whose labels are final.
struct LabelledScan {
  std::size_t scan_index = 0;         ///< counts pushed scans from 0
  std::vector<std::uint32_t> labels;  ///< kStaticLabel or kMovingLabel, one per pushed point
  std::vector<float> scores;          ///< larger: more likely to move; empty unless asked for
  std::vector<Reason> reasons;        ///< the same; empty of methods that give none
  /// Number of the object of each point, moving by its labels or not, from 1 and the same in all
  /// scans, 0 for none; empty when the method finds none, and of whole tracks without scores.
  std::vector<std::uint32_t> objects;
  std::optional<double> threshold;   ///< that the scores were compared with, if there is one
  bool judged = false;               ///< false: too little past or future, all points are static
  std::size_t nonfinite_points = 0;  ///< NaN or infinite: left out and labelled static
  std::vector<StageTime> stages;     ///< in the order in which they ran; a name may recur
};

/// A scan after the work that needs no scans before it. What is in it is known to its method alone.
class Observed {
 public:
  virtual ~Observed() = default;
};

/// What a method keeps between scans.
struct MemoryUse {
  std::size_t bytes = 0;       ///< of its containers
  std::size_t map_blocks = 0;  ///< blocks or cells of its map
};

/// A method that segments moving points online: scans are pushed in order, labels come out. Methods
/// share nothing with one another, and labels are the same bits for any number of threads.
class Method {
 public:
  virtual ~Method() = default;

  /// Does what needs no scans before it. May run while another thread pushes the previous scan;
  /// scans are observed one after the other, in order. Throws std::range_error naming the point
  /// when a coordinate is out of reach of the map, and for a pose that is not rigid;
  /// std::invalid_argument for origins that do not fit the points, or that the method cannot take.
  virtual std::unique_ptr<Observed> observe(std::span<const Point> points,
                                            const Pose& map_from_sensor,
                                            const RayOrigins& origins = {}) = 0;

  /// Takes an observed scan in and returns the scans whose labels became final, in order: this one
  /// when online; none or earlier ones when delayed. Throws std::logic_error beyond
  /// RunContext::scan_count scans, after `finish`, and for a scan that another method observed.
  virtual std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) = 0;

  /// The same for a scan that was not observed before.
  virtual std::vector<LabelledScan> push(std::span<const Point> points, const Pose& map_from_sensor,
                                         const RayOrigins& origins = {}) {
    return push(observe(points, map_from_sensor, origins));
  }

  /// Returns the labels still held back by a delay, in order. Nothing can be pushed after it.
  virtual std::vector<LabelledScan> finish() { return {}; }

  /// Returns nullopt when the method does not measure it. To be asked while no scan is observed.
  virtual std::optional<MemoryUse> memory() const { return std::nullopt; }

  /// Returns what a reader of the labels should know about them, in plain sentences.
  virtual std::vector<std::string> remarks() const { return {}; }
};

/// Under which conditions a method runs. Labels depend on scan_count and stamps_ns alone.
struct RunContext {
  unsigned threads = 1;  ///< at least 1
  /// Length of the sequence when it is known: the end of a delayed run may be labelled in another
  /// way.
  std::optional<std::size_t> scan_count = std::nullopt;
  bool scores = false;     ///< results hold a score per point, and of some methods a reason
  bool cpu_times = false;  ///< stages hold their CPU time, too
  /// When each scan was measured, ns since 1970 or since the start; empty when unknown.
  std::vector<std::int64_t> stamps_ns = {};
};

/// A setting with a value of its own.
struct PresetValue {
  std::string_view setting;  ///< its name
  SettingValue value;        ///< taken instead of the default
};

/// A short word for settings of a method that go together, as `--set moving=ever:5` of
/// hmm-mos-plus.
struct SettingWord {
  std::string_view name;                ///< "moving"
  std::string_view usual;               ///< its value that sets nothing: "now"
  std::string_view value;               ///< the other one: "ever", or with a number "ever:5"
  std::string_view number;              ///< what the number is: "SECONDS"
  std::vector<std::string_view> takes;  ///< settings that take the number, or their highest value
  std::vector<PresetValue> sets;        ///< what it sets besides
  std::string_view lacking;             ///< of other methods: "does not remember what moved"
};

/// One method that can be run by name.
struct MethodKind {
  std::string_view name;     ///< "hmm-mos"
  std::string_view title;    ///< as tables print it: "HMM-MOS"
  std::string_view source;   ///< the paper
  std::string_view summary;  ///< one line
  Settings defaults;         ///< the values of the paper
  /// Throws std::invalid_argument "<setting>: <what is wrong>, <what was expected>" for values that
  /// do not go together.
  void (*check)(const Settings& settings);
  /// Checks, then makes. Also throws std::invalid_argument for 0 threads.
  std::function<std::unique_ptr<Method>(const Settings& settings, const RunContext& context)> make;
  /// The labels of another method from slower, simpler code: for tests, not for a benchmark.
  bool is_twin = false;
  std::string_view score_name = "score";  ///< what scores are, with unit: "margin, m"
  /// What LabelledScan::threshold is, "Otsu threshold"; empty when no threshold is worth showing.
  std::string_view threshold_name = "";
  bool takes_origins = false;           ///< of several sensors; else it refuses RayOrigins
  bool gives_reasons = false;           ///< results with scores also say why each point moves
  bool is_named_by_variant = false;     ///< folders of its runs are called by its variant
  std::vector<SettingWord> words = {};  ///< short words that --set takes
};

/// All methods, the default one first.
std::span<const MethodKind> methods();

/// Returns the method that runs when none is named.
const MethodKind& default_method();

/// Returns nullptr when there is no method of this name.
const MethodKind* find_method(std::string_view name);

/// Published settings. Methods take the values of the settings that they have; the others keep
/// their defaults.
struct MethodPreset {
  std::string_view name;            ///< "doals-20m"
  std::vector<PresetValue> values;  ///< in the order in which they are set
  std::string_view source;          ///< where the values come from
  std::string_view method = {};     ///< the one that it is of; empty: any
};

/// All presets, in the order in which they are shown.
std::span<const MethodPreset> method_presets();

}  // namespace mosbench
