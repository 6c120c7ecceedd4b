#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result_format.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::optional<LabelHash> hash_from(const ordered_json& json, const std::string& name,
                                   const std::filesystem::path& file) {
  const std::string text = json.value(name, "");
  if (text.empty()) return std::nullopt;
  LabelHash hash;
  if (text.size() != hash.size()) {
    throw DataError(file, '"' + name + "\" is " + mosbench::quoted(text) + ", no 16 digits",
                    "a result.json of mosbench run");
  }
  std::ranges::copy(text, hash.begin());
  return hash;
}

/// Conversions of JSON numbers would cut fractions off and let negative ones wrap around.
std::uint64_t count_from(const ordered_json& json, const char* name,
                         const std::filesystem::path& file) {
  const ordered_json& count = json.at(name);
  if (count.is_number_unsigned()) return count.get<std::uint64_t>();
  throw DataError(file,
                  fmt::format("\"{}\" of scan {} is {}", name, json.at("stem").dump(),
                              count.dump(-1, ' ', false, ordered_json::error_handler_t::replace)),
                  "a number of points");
}

void check_sums(const ScanRow& row, const std::filesystem::path& file) {
  const Confusion counts = row.counts.value_or(Confusion{.ignored = row.points});
  // No sum can wrap to a match: every part is at most the points.
  const bool fits =
      std::max({counts.tp, counts.fp, counts.fn, counts.tn, counts.ignored,
                std::uint64_t{row.nonfinite_points}, std::uint64_t{row.predicted_moving_points}}) <=
          row.points &&
      counts.points() == row.points && counts.tp + counts.fp <= row.predicted_moving_points;
  if (fits) return;
  throw DataError(
      file, fmt::format("the counts of scan \"{}\" do not fit its {} points", row.stem, row.points),
      "tp + fp + fn + tn + ignored = points, and tp + fp <= predicted_moving_points <= "
      "points");
}

ScanRow row_from_json(const ordered_json& json, const std::filesystem::path& file) {
  const auto count = [&](const char* name) { return count_from(json, name, file); };
  ScanRow row;
  row.stem = json.at("stem").get<std::string>();
  row.points = count("points");
  row.predicted_moving_points = count("predicted_moving_points");
  row.nonfinite_points = count("nonfinite_points");
  if (!json.at("threshold").is_null()) row.threshold = json.at("threshold").get<double>();
  row.label_hash = hash_from(json, "label_hash", file);
  if (json.contains("tp")) {
    row.counts = Confusion{count("tp"), count("fp"),      count("fn"),
                           count("tn"), count("ignored"), count("unknown_ids")};
    row.truth_hash = hash_from(json, "truth_hash", file);
  }
  check_sums(row, file);
  return row;
}

/// Scores of others' labels name no scans that were not judged.
void read_scans(const ordered_json& content, Result& result) {
  const std::set<std::string> unjudged =
      content.value("scans_without_detection", std::set<std::string>());
  for (const ordered_json& json : content.at("scans")) {
    ScanRow& row = result.scans.emplace_back(row_from_json(json, result.file));
    row.judged = !unjudged.contains(row.stem);
  }
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

OdometryDone odometry_from(const ordered_json& json) {
  return {json.at("name"), recorded_settings(json.at("settings")), json.value("map", "")};
}

SimulatedOrigin simulated_from(const ordered_json& json) {
  SimulatedOrigin origin;
  origin.scene = json.at("scene");
  origin.seed = json.at("seed");
  origin.scene_fingerprint = json.value("scene_fingerprint", "");
  if (json.contains("perturb")) origin.perturb = json.at("perturb").get<std::string>();
  return origin;
}

void read_provenance(const ordered_json& content, Provenance& from) {
  const ordered_json& json = content.at("provenance");
  from.version = json.value("version", "");
  from.compiler = json.value("compiler", "");
  from.fingerprint = json.value("fingerprint", "");
  from.fingerprint_without_poses = json.value("fingerprint_without_poses", "");
  if (json.contains("machine")) {
    const ordered_json& machine = json.at("machine");
    from.machine = {machine.value("processor", "unknown"), machine.value("logical_cores", 0U),
                    machine.value("memory_mib", 0.0), machine.value("system", "")};
  }
  if (json.contains("simulated")) from.simulated = simulated_from(json.at("simulated"));
  const ordered_json reading = content.value("reading", ordered_json::object());
  for (const auto& [what, how] : reading.items()) {
    from.reading.emplace_back(what, how.get<std::string>());
  }
  if (content.contains("odometry")) from.odometry = odometry_from(content.at("odometry"));
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

void read_findings(const ordered_json& content, Result& result) {
  result.remarks = content.value("remarks", std::vector<std::string>());
  result.scans_left_out = content.value("scans_left_out", std::vector<std::string>());
  if (content.contains("doubtful_poses")) {
    std::vector<DoubtfulPose>& doubtful = result.doubtful_poses.emplace();
    for (const ordered_json& pose : content.at("doubtful_poses")) {
      doubtful.push_back({pose.at("stem"), pose.at("doubt")});
    }
  }
  if (content.contains("predictions")) {
    const ordered_json& json = content.at("predictions");
    result.predictions = {json.value("format", ""), json.value("guessed", false),
                          json.value("path", ""), json.at("missing"),
                          json.value("remarks", std::vector<std::string>())};
  }
  if (content.contains("splits")) content.at("splits").get_to(result.splits);
  if (const ordered_json split = content.value("summary_split", ordered_json()); !split.is_null()) {
    result.summary_split = split.get<std::string>();
  }
}

constexpr std::size_t kBeforeStages = 3;

Timing timing_from(const ordered_json& json) {
  Timing timing;
  timing.threads = json.value("threads", 0U);
  timing.wall_s = json.at("wall_s");
  if (json.contains("core_s") && !json.at("core_s").is_null()) timing.core_s = json.at("core_s");
  const ordered_json& columns = json.at("scan_columns");
  for (std::size_t i = kBeforeStages; i < columns.size(); ++i) {
    std::string stage = columns.at(i);
    if (stage.ends_with("_ms")) stage.resize(stage.size() - 3);
    timing.stages.push_back(std::move(stage));
  }
  for (const ordered_json& row : json.at("scans")) {
    ScanCost& cost = timing.costs.emplace_back();
    cost.read_ms = row.at(0);
    cost.push_ms = row.at(1);
    cost.resident_mib = row.at(2);
    for (std::size_t s = 0; s < timing.stages.size(); ++s) {
      cost.stages_ms.push_back(row.at(kBeforeStages + s));
    }
  }
  return timing;
}

PredictionSource source_from(const ordered_json& json) {
  PredictionSource source;
  source.path = json.at("path").get<std::string>();
  if (json.contains("format")) {
    source.options.format = prediction_format_named(json.at("format").get<std::string>());
  }
  source.options.level = dynablox_level_named(json.value("level", "object"));
  if (json.contains("mask_m")) {
    source.options.mask = {json.at("mask_m").at(0), json.at("mask_m").at(1)};
  }
  if (json.contains("id_map")) source.options.id_map = parse_id_map(json.at("id_map"));
  return source;
}

Places places_from(const ordered_json& json) {
  Places places;
  if (json.contains("dataset_root"))
    places.dataset_root = json.at("dataset_root").get<std::string>();
  places.reading = told_from_json(json.at("reading"));
  if (json.contains("predictions")) places.predictions = source_from(json.at("predictions"));
  places.file_stamp = json.value("file_stamp", "");
  places.sequences_of_run = json.value("sequences_of_run", std::vector<std::string>());
  return places;
}

Result from_present_format(const ordered_json& content, const std::filesystem::path& file) {
  Result result;
  result.file = file;
  result.key = content.value("key", "");
  result.sequence = SequenceName(content.at("sequence"), file);
  result.dataset = content.at("dataset");
  result.preset = content.value("preset", "");
  read_method(content, result);
  read_protocol(content, result);
  read_provenance(content, result.from);
  result.from.program = content.value("program", "");
  read_findings(content, result);
  read_scans(content, result);
  check_summary(content, result);
  // Accepted results (baselines) and scores of others' labels come without a clock.
  if (content.contains("timing")) result.timing = timing_from(content.at("timing"));
  if (content.contains("places")) result.places = places_from(content.at("places"));
  return result;
}

}  // namespace

Result result_from_json(ordered_json content, const std::filesystem::path& file) {
  try {
    const bool is_first = content.is_object() && !content.contains("format");
    Result result = from_present_format(in_present_format(std::move(content), file), file);
    result.has_whole_scores = is_first;
    return result;
  } catch (const ordered_json::exception& error) {
    throw DataError(file, error.what(), "a result.json of mosbench");
  } catch (const UsageError& error) {
    throw DataError(file, error.what(), "a result.json of this mosbench");
  }
}

}  // namespace mosbench
