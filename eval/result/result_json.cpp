#include "eval/result/result_json.hpp"

#include <fmt/format.h>

#include <concepts>
#include <set>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// How a member is written, and whether it may be missing where it is read.
enum class Member : std::uint8_t {
  kNeeded,
  kUsual,  ///< is written always, but not by every earlier mosbench
  kIfSet,  ///< is left out where there is none
  kIfAny   ///< of a list: likewise, or where it is empty
};

// The one list of the members of each record, by which they are written and read.
template <typename Type, typename Record>
concept Is = std::same_as<std::remove_const_t<Type>, Record>;

template <Is<Machine> Record>
void visit_members(Record& machine, auto&& visit) {
  visit("processor", machine.processor, Member::kUsual);
  visit("logical_cores", machine.logical_cores, Member::kUsual);
  visit("memory_mib", machine.memory_mib, Member::kUsual);
  visit("system", machine.system, Member::kUsual);
}

template <Is<SimulatedOrigin> Record>
void visit_members(Record& origin, auto&& visit) {
  visit("scene", origin.scene, Member::kNeeded);
  visit("seed", origin.seed, Member::kNeeded);
  visit("scene_fingerprint", origin.scene_fingerprint, Member::kUsual);
  std::string notice = simulated_notice(origin);  // for those who read the file
  visit("notice", notice, Member::kUsual);
  visit("perturb", origin.perturb, Member::kIfSet);
}

template <Is<Provenance> Record>
void visit_members(Record& from, auto&& visit) {
  visit("version", from.version, Member::kUsual);
  visit("compiler", from.compiler, Member::kIfSet);
  visit("machine", from.machine, Member::kIfSet);
  visit("fingerprint", from.fingerprint, Member::kIfSet);
  visit("fingerprint_without_poses", from.fingerprint_without_poses, Member::kIfSet);
  visit("simulated", from.simulated, Member::kIfSet);
}

template <Is<ProgramFile> Record>
void visit_members(Record& file, auto&& visit) {
  visit("path", file.path, Member::kNeeded);
  visit("bytes", file.bytes, Member::kNeeded);
  visit("hash", file.hash, Member::kNeeded);
}

template <Is<OdometryDone> Record>
void visit_members(Record& odometry, auto&& visit) {
  visit("name", odometry.name, Member::kNeeded);
  visit("settings", odometry.settings, Member::kNeeded);
  visit("map", odometry.map, Member::kIfSet);
}

template <Is<ScoredPredictions> Record>
void visit_members(Record& predictions, auto&& visit) {
  visit("format", predictions.format, Member::kUsual);
  visit("guessed", predictions.guessed, Member::kUsual);
  visit("path", predictions.path, Member::kUsual);
  visit("missing", predictions.missing, Member::kNeeded);
  visit("remarks", predictions.remarks, Member::kUsual);
}

template <Is<DoubtfulPose> Record>
void visit_members(Record& pose, auto&& visit) {
  visit("stem", pose.stem, Member::kNeeded);
  visit("doubt", pose.doubt, Member::kNeeded);
}

template <Is<Acceptance> Record>
void visit_members(Record& accepted, auto&& visit) {
  visit("why", accepted.why, Member::kNeeded);
  visit("on", accepted.on, Member::kNeeded);
}

template <Is<RunCost> Record>
void visit_members(Record& cost, auto&& visit) {
  visit("core_ms_per_scan", cost.core_ms_per_scan, Member::kIfSet);
  visit("calibration_ms", cost.calibration_ms, Member::kIfSet);
  visit("most_resident_mib", cost.most_resident_mib, Member::kNeeded);
  visit("bytes_written", cost.bytes_written, Member::kNeeded);
  visit("machine", cost.machine, Member::kIfSet);
  visit("what_written", cost.what_written, Member::kIfAny);
}

template <Is<PredictionSource> Record>
void visit_members(Record& source, auto&& visit) {
  visit("path", source.path, Member::kNeeded);
  visit("level", source.options.level, Member::kUsual);
  visit("format", source.options.format, Member::kIfSet);
  visit("mask_m", source.options.mask, Member::kIfSet);
  visit("id_map", source.options.id_map, Member::kIfSet);
}

template <Is<Places> Record>
void visit_members(Record& places, auto&& visit) {
  visit("dataset_root", places.dataset_root, Member::kIfSet);
  visit("reading", places.reading, Member::kNeeded);
  visit("predictions", places.predictions, Member::kIfSet);
  visit("file_stamp", places.file_stamp, Member::kIfSet);
  visit("sequences_of_run", places.sequences_of_run, Member::kIfAny);
}

/// What decides no labels; `unjudged` are the stems of scans that the method did not look at.
void visit_findings(auto& result, auto& unjudged, auto&& visit) {
  visit("preset", result.preset, Member::kIfSet);
  visit("accepted", result.accepted, Member::kIfSet);
  visit("cost", result.cost, Member::kIfSet);
  visit("settings_from", result.settings_from, Member::kIfSet);
  visit("program", result.from.program, Member::kIfSet);
  visit("program_files", result.from.program_files, Member::kIfAny);
  visit("odometry", result.from.odometry, Member::kIfSet);
  visit("provenance", result.from, Member::kNeeded);
  visit("predictions", result.predictions, Member::kIfSet);
  visit("remarks", result.remarks, Member::kUsual);
  visit("doubts", result.doubts, Member::kIfAny);
  visit("scans_without_detection", unjudged, Member::kUsual);
  visit("scans_left_out", result.scans_left_out, Member::kIfAny);
  visit("doubtful_poses", result.doubtful_poses, Member::kIfSet);
  visit("splits", result.splits, Member::kIfAny);
  visit("summary_split", result.summary_split, Member::kUsual);
}

template <typename Record>
concept HasMembers = requires(Record& record) {
  visit_members(record, [](const char*, auto&, Member) {});
};

template <typename Value>
concept IsListOfRecords =
    std::same_as<Value, std::vector<DoubtfulPose>> || std::same_as<Value, std::vector<ProgramFile>>;

ordered_json written(const std::filesystem::path& path) { return path.string(); }
ordered_json written(const RecordedSettings& settings) { return to_json(settings); }
ordered_json written(const Reading& reading) { return told_json(reading); }
ordered_json written(const RangeGate& range) { return {range.min_m, range.max_m}; }
ordered_json written(const LabelIdMap& map) { return id_map_text(map); }
ordered_json written(DynabloxLevel level) { return to_string(level); }
ordered_json written(PredictionFormat format) { return describe(format).name; }
template <typename Value>
ordered_json written(const Value& value);

/// Visits members and adds them to an object.
auto adding_to(ordered_json& json) {
  return [&json](const char* name, const auto& member, Member kind) {
    ordered_json value = written(member);
    const bool is_left_out = kind == Member::kIfSet ? value.is_null() || value == ""
                                                    : kind == Member::kIfAny && value.empty();
    if (!is_left_out) json[name] = std::move(value);
  };
}

template <typename Value>
ordered_json written(const Value& value) {
  ordered_json json;
  if constexpr (HasMembers<const Value>) {
    visit_members(value, adding_to(json = ordered_json::object()));
  } else if constexpr (IsListOfRecords<Value>) {
    json = ordered_json::array();
    for (const auto& each : value) json.push_back(written(each));
  } else if constexpr (requires { value.has_value(); }) {
    if (value) json = written(*value);
  } else {
    json = value;
  }
  return json;
}

void read(const ordered_json& json, std::filesystem::path& path) { path = json.get<std::string>(); }
void read(const ordered_json& json, RecordedSettings& settings) {
  settings = recorded_settings(json);
}
void read(const ordered_json& json, Reading& reading) { reading = told_from_json(json); }
void read(const ordered_json& json, RangeGate& range) { range = {json.at(0), json.at(1)}; }
void read(const ordered_json& json, LabelIdMap& map) { map = parse_id_map(json); }
void read(const ordered_json& json, DynabloxLevel& level) {
  level = dynablox_level_named(json.get<std::string>());
}
void read(const ordered_json& json, PredictionFormat& format) {
  format = prediction_format_named(json.get<std::string>());
}
template <typename Value>
void read(const ordered_json& json, Value& value);

/// Visits members and reads those that an object has.
auto taking_from(const ordered_json& json) {
  return [&json](const char* name, auto& member, Member kind) {
    if (!json.is_object()) throw MemberFault("is no object");
    if (!json.contains(name)) {
      if (kind == Member::kNeeded) throw MemberFault(fmt::format("lacks \"{}\"", name));
      return;
    }
    try {
      read(json.at(name), member);
    } catch (const MemberFault& fault) {
      throw MemberFault(fmt::format("\"{}\" {}", name, fault.what()));
    } catch (const ordered_json::exception& error) {
      throw MemberFault(fmt::format("\"{}\" {}", name, sentence_of(error)));
    }
  };
}

template <typename Value>
void read(const ordered_json& json, Value& value) {
  if constexpr (HasMembers<Value>) {
    visit_members(value, taking_from(json));
  } else if constexpr (IsListOfRecords<Value>) {
    for (const ordered_json& each : json) read(each, value.emplace_back());
  } else if constexpr (requires { value.has_value(); }) {
    if (!json.is_null()) read(json, value.emplace());
  } else {
    json.get_to(value);
  }
}

ordered_json method_json(const Result& result) {
  if (result.kind.empty()) return {{"name", result.method}, {"setting", result.setting}};
  return {{"name", result.method}, {"kind", result.kind}};
}

/// Results of `mosbench run` hold the settings themselves, those of `mosbench score` what the user
/// calls them.
void read_method(const ordered_json& content, Result& result) {
  const ordered_json& method = content.at("method");
  result.method = method.at("name");
  if (method.contains("setting")) {
    result.setting = method.at("setting").get<std::string>();
    return;
  }
  result.kind = method.at("kind").get<std::string>();
  try {
    result.settings = recorded_settings(content.at("settings"));
    check_recorded_settings(*result.settings, result.kind);
  } catch (const std::invalid_argument& error) {
    throw DataError(fmt::format("{}: settings: {}", result.file.string(), error.what()));
  }
  result.setting = describe_settings(*result.settings, result.kind);
}

void read_protocol(const ordered_json& content, Result& result) {
  const ordered_json& protocol = content.at("protocol");
  result.protocol = find_protocol(protocol.at("name").get<std::string>());
  if (result.protocol == nullptr) {
    throw DataError(result.file, "names protocol " + protocol.at("name").dump(),
                    "one that `mosbench list protocols` shows");
  }
  result.range = {protocol.at("min_range_m"), protocol.at("max_range_m")};
}

ordered_json summary_json(const Result& result) {
  const SequenceCounts counts = counts_of(result);
  return counts.empty() ? ordered_json() : to_json(summarize(*result.protocol, counts));
}

/// Throws DataError where a summary is not that of the scans, as in a file that was edited.
void check_summary(const ordered_json& content, const Result& result) {
  const ordered_json summary = content.value("summary", ordered_json());
  if (!summary.is_object()) return;
  Confusion pooled;
  for (const ScanRow* row : counted_scans(result)) pooled += *row->counts;
  const ordered_json added_up = counts_json(pooled);
  for (const auto& [name, count] : added_up.items()) {
    if (!summary.contains(name) || summary.at(name) == count) continue;
    throw DataError(result.file,
                    fmt::format("\"{}\" of its scans add up to {}, that of its summary is {}", name,
                                count.dump(), summary.at(name).dump()),
                    "a result.json that nobody has changed");
  }
}

}  // namespace

ordered_json to_json(const Machine& machine) { return written(machine); }
ordered_json to_json(const SimulatedOrigin& origin) { return written(origin); }
ordered_json to_json(const ScoredPredictions& predictions) { return written(predictions); }

ordered_json identity_json(const Result& result) {
  ordered_json json = {{"sequence", result.sequence.text()},
                       {"dataset", result.dataset},
                       {"reading", to_json(result.from.reading)},
                       {"method", method_json(result)},
                       {"protocol", rule_json({result.protocol, result.range}, "name")}};
  if (result.settings) json["settings"] = to_json(*result.settings);
  if (!result.settings_from.empty()) json["settings_from"] = result.settings_from;
  json["code"] = {{"version", result.from.version}, {"compiler", result.from.compiler}};
  return json;
}

ordered_json header_json(const Result& result) {
  ordered_json json = {{"format", kResultFormat}};
  if (!result.key.empty()) json["key"] = result.key;
  json.update(identity_json(result));
  json.erase("code");
  std::vector<std::string> unjudged;
  for (const ScanRow& row : result.scans) {
    if (!row.judged) unjudged.push_back(row.stem);
  }
  visit_findings(result, unjudged, adding_to(json));
  json["summary"] = summary_json(result);
  return json;
}

ordered_json to_json(const Result& result) {
  ordered_json json = header_json(result);
  json["scans"] = ordered_json::array();
  for (const ScanRow& row : result.scans) json["scans"].push_back(row_json(row));
  if (result.timing) json["timing"] = timing_json(result);
  if (result.places) json["places"] = written(*result.places);
  return json;
}

Result result_from_json(const ordered_json& content, const std::filesystem::path& file) {
  Result result;
  result.file = file;
  result.key = content.value("key", "");
  result.sequence = SequenceName(content.at("sequence"), file);
  result.dataset = content.at("dataset");
  read_method(content, result);
  read_protocol(content, result);
  const ordered_json reading = content.value("reading", ordered_json::object());
  for (const auto& [what, how] : reading.items()) {
    result.from.reading.emplace_back(what, how.get<std::string>());
  }
  std::vector<std::string> stems;  // none in scores of others' labels
  visit_findings(result, stems, taking_from(content));
  const std::set<std::string> unjudged(stems.begin(), stems.end());
  for (const ordered_json& json : content.at("scans")) {
    ScanRow& row = result.scans.emplace_back(row_from_json(json, file));
    row.judged = !unjudged.contains(row.stem);
  }
  check_summary(content, result);
  // Accepted results (baselines) and scores of others' labels come without a clock.
  if (content.contains("timing")) result.timing = timing_from_json(content.at("timing"));
  if (content.contains("places")) read(content.at("places"), result.places.emplace());
  return result;
}

}  // namespace mosbench
