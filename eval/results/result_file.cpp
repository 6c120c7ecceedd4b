#include "eval/results/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/sequence/sequence_name.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/results/result_format.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::string dump(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::string_view text_of(const LabelHash& hash) { return {hash.data(), hash.size()}; }

ordered_json to_json(const ScanRow& row) {
  ordered_json json = {{"stem", row.stem},
                       {"points", row.points},
                       {"predicted_moving_points", row.predicted_moving_points},
                       {"nonfinite_points", row.nonfinite_points},
                       {"threshold", json_or_null(row.threshold)}};
  if (row.label_hash) json["label_hash"] = text_of(*row.label_hash);
  if (!row.counts) return json;
  json.update(counts_json(*row.counts));
  json["unknown_ids"] = row.counts->unknown_ids;
  if (row.truth_hash) {
    json["truth_hash"] = text_of(*row.truth_hash);
  }
  return json;
}

constexpr const char* kExpected = "a result.json of mosbench run";

std::optional<LabelHash> hash_from(const ordered_json& json, const std::string& name,
                                   const std::filesystem::path& file) {
  const std::string text = json.value(name, "");
  if (text.empty()) return std::nullopt;
  LabelHash hash;
  if (text.size() != hash.size()) {
    throw DataError(file, '"' + name + "\" is " + mosbench::quoted(text) + ", no 16 digits",
                    kExpected);
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
                  fmt::format("\"{}\" of scan {} is {}", name, json.at("stem").dump(), dump(count)),
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

// One array per scan, its meaning in "scan_columns": a tenth of the size of named members.
constexpr std::size_t kCostColumns = 3;

ordered_json to_json(const ScanCost& cost, std::size_t stages) {
  ordered_json json = {cost.read_ms, cost.push_ms, cost.resident_mib};
  for (std::size_t s = 0; s < stages; ++s) {
    json.push_back(s < cost.stages_ms.size() ? cost.stages_ms[s] : 0.0);
  }
  return json;
}

ScanCost cost_from_json(const ordered_json& json, std::size_t stages) {
  ScanCost cost;
  cost.read_ms = json.at(0);
  cost.push_ms = json.at(1);
  cost.resident_mib = json.at(2);
  for (std::size_t s = 0; s < stages; ++s) cost.stages_ms.push_back(json.at(kCostColumns + s));
  return cost;
}

ordered_json cost_columns(const SequenceRows& rows) {
  ordered_json columns = {"read_ms", "push_ms", "resident_mib"};
  for (const std::string& stage : rows.stages) columns.push_back(stage + "_ms");
  return columns;
}

std::vector<std::string> stages_of(const ordered_json& columns) {
  std::vector<std::string> stages;
  for (std::size_t i = kCostColumns; i < columns.size(); ++i) {
    std::string stage = columns.at(i);
    if (stage.ends_with("_ms")) stage.resize(stage.size() - 3);
    stages.push_back(std::move(stage));
  }
  return stages;
}

ordered_json mean_stages_ms(const SequenceRows& rows) {
  ordered_json means = ordered_json::object();
  if (rows.costs.empty()) return means;
  for (std::size_t s = 0; s < rows.stages.size(); ++s) {
    double sum_ms = 0.0;
    for (const ScanCost& cost : rows.costs) {
      if (s < cost.stages_ms.size()) sum_ms += cost.stages_ms[s];
    }
    means[rows.stages[s]] = sum_ms / static_cast<double>(rows.costs.size());
  }
  return means;
}

ordered_json timing(const SequenceRows& rows, unsigned threads, const ordered_json& clock_header) {
  ordered_json json = clock_header;
  json["threads"] = threads;
  json["wall_s"] = rows.wall_s;
  json["method_ms_per_scan"] = json_or_null(method_ms_per_scan(rows));
  json["stage_ms_per_scan"] = mean_stages_ms(rows);
  json["scan_columns"] = cost_columns(rows);
  json["scans"] = ordered_json::array();
  for (const ScanCost& cost : rows.costs)
    json["scans"].push_back(to_json(cost, rows.stages.size()));
  return json;
}

// Indented like dump(1), but with one line per scan.
void append_members(const ordered_json& object, const std::string& indent, std::string& text) {
  for (const auto& [key, value] : object.items()) {
    text += indent + ordered_json(key).dump() + ": ";
    if (key == "scans") {
      text += "[";
      for (std::size_t i = 0; i < value.size(); ++i) {
        text += (i == 0 ? "\n" : ",\n") + indent + " " + dump(value[i]);
      }
      text += "\n" + indent + "]";
    } else if (value.is_object() && !value.empty()) {
      text += "{\n";
      append_members(value, indent + " ", text);
      text += indent + "}";
    } else {
      text += dump(value);
    }
    text += ",\n";
  }
  text.erase(text.size() - 2, 1);
}

std::string format_members(const ordered_json& json) {
  std::string text = "{\n";
  append_members(json, " ", text);
  return text + "}\n";
}

ordered_json with_scans(ordered_json json, const std::vector<ScanRow>& scans) {
  json["scans"] = ordered_json::array();
  for (const ScanRow& row : scans) json["scans"].push_back(to_json(row));
  return json;
}

/// Returns whether the result in a folder is of a sequence of that name.
bool holds_own_result(const std::filesystem::path& folder) {
  try {
    const ordered_json content = read_result(folder / "result.json").content;
    const std::string name = content.value("sequence", "");
    return std::filesystem::path(name).filename() == folder.filename();
  } catch (const std::exception&) {
    return false;
  }
}

/// Returns whether no result is to be looked for in a folder: a run keeps files per scan there, or
/// was killed, or is about to replace it. A sequence may be called like that, too.
bool is_passed_over(const std::filesystem::path& folder) {
  if (std::ranges::find(kScanFileFolders, folder.filename().string()) != kScanFileFolders.end()) {
    return is_there(folder.parent_path() / "result.json");
  }
  const bool leftover = folder.extension() == ".partial" || folder.extension() == ".replaced";
  return leftover && !holds_own_result(folder);
}

/// Scores of others' labels name no such scans.
void mark_unjudged(ResultFile& result) {
  if (!result.content.contains("scans_without_detection")) return;
  const std::set<std::string> stems = result.content.at("scans_without_detection");
  for (ScanRow& row : result.rows.scans) row.judged = !stems.contains(row.stem);
}

}  // namespace

bool are_labels_of(const ScanRow& row, std::span<const std::uint32_t> labels) {
  if (row.label_hash) return hash_of_labels(labels) == row.label_hash;
  const auto moving = static_cast<std::size_t>(std::ranges::count(labels, kMovingLabel));
  return moving == row.predicted_moving_points;
}

void add_stages(const std::vector<StageTime>& stages, SequenceRows& rows, ScanCost& cost) {
  for (const StageTime& stage : stages) {
    const auto found = std::ranges::find(rows.stages, stage.name);
    const auto position = static_cast<std::size_t>(found - rows.stages.begin());
    if (found == rows.stages.end()) rows.stages.emplace_back(stage.name);
    if (cost.stages_ms.size() <= position) cost.stages_ms.resize(position + 1);
    cost.stages_ms[position] += stage.wall_ms;
  }
}

std::optional<double> method_ms_per_scan(const SequenceRows& rows) {
  if (rows.costs.empty()) return std::nullopt;
  double sum_ms = 0.0;
  for (const ScanCost& cost : rows.costs) sum_ms += cost.push_ms;
  return sum_ms / static_cast<double>(rows.costs.size());
}

std::string format_result(const ordered_json& header, const SequenceRows& rows, unsigned threads,
                          const ordered_json& clock_header) {
  ordered_json json = with_scans(header, rows.scans);
  json["timing"] = timing(rows, threads, clock_header);
  return format_members(json);
}

std::string format_scored(const ordered_json& header, const std::vector<ScanRow>& scans) {
  return format_members(with_scans(header, scans));
}

std::vector<std::filesystem::path> find_result_files(const std::filesystem::path& path,
                                                     std::filesystem::directory_options how,
                                                     int deepest) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return {path};
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator it(path, how, error), end; !error && it != end;
       it.increment(error)) {
    if (is_passed_over(it->path())) {
      it.disable_recursion_pending();
    } else if (it->path().filename() == "result.json") {
      files.push_back(it->path());
    }
    if (it.depth() >= deepest) it.disable_recursion_pending();
  }
  if (error) throw DataError(path, "cannot be read (" + error.message() + ")", "results");
  std::ranges::sort(files);
  return files;
}

std::vector<std::filesystem::path> result_files(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files = find_result_files(path);
  if (!files.empty()) return files;
  throw DataError(path, "holds no result.json", "results of mosbench run or mosbench score");
}

ResultFile read_result(const std::filesystem::path& file) {
  try {
    ResultFile result;
    result.content = in_present_format(parse_json(read_file(file), file), file);
    for (const ordered_json& row : result.content.at("scans")) {
      result.rows.scans.push_back(row_from_json(row, file));
    }
    mark_unjudged(result);
    result.rows.fingerprint = result.content.value("fingerprint", "");
    result.rows.fingerprint_without_poses = result.content.value("fingerprint_without_poses", "");
    // Accepted results (baselines) and scores of others' labels come without a clock.
    if (!result.content.contains("timing")) return result;
    const ordered_json& clocked = result.content.at("timing");
    result.rows.wall_s = clocked.at("wall_s");
    result.rows.stages = stages_of(clocked.at("scan_columns"));
    for (const ordered_json& cost : clocked.at("scans")) {
      result.rows.costs.push_back(cost_from_json(cost, result.rows.stages.size()));
    }
    return result;
  } catch (const ordered_json::exception& error) {
    throw DataError(file, error.what(), kExpected);
  }
}

}  // namespace mosbench
