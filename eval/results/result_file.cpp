#include "eval/results/result_file.hpp"

#include <algorithm>
#include <system_error>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/text.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/result_format.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const ScanRow& row) {
  ordered_json json = {{"stem", row.stem},
                       {"points", row.points},
                       {"predicted_moving_points", row.predicted_moving_points},
                       {"nonfinite_points", row.nonfinite_points},
                       {"threshold", json_or_null(row.threshold)}};
  if (!row.counts) return json;
  json.update(counts_json(*row.counts));
  json["unknown_ids"] = row.counts->unknown_ids;
  if (row.truth_hash) {
    json["truth_hash"] = std::string_view(row.truth_hash->data(), row.truth_hash->size());
  }
  return json;
}

constexpr const char* kExpected = "a result.json of mosbench run";

std::optional<TruthHash> truth_hash_from(const std::string& text,
                                         const std::filesystem::path& file) {
  if (text.empty()) return std::nullopt;
  TruthHash hash;
  if (text.size() != hash.size()) {
    throw DataError(file, "\"truth_hash\" is " + mosbench::quoted(text) + ", no 16 digits",
                    kExpected);
  }
  std::ranges::copy(text, hash.begin());
  return hash;
}

ScanRow row_from_json(const ordered_json& json, const std::filesystem::path& file) {
  ScanRow row;
  row.stem = json.at("stem").get<std::string>();
  row.points = json.at("points").get<std::size_t>();
  row.predicted_moving_points = json.at("predicted_moving_points").get<std::size_t>();
  row.nonfinite_points = json.at("nonfinite_points").get<std::size_t>();
  if (!json.at("threshold").is_null()) row.threshold = json.at("threshold").get<double>();
  if (json.contains("tp")) {
    row.counts = Confusion{json.at("tp"), json.at("fp"),      json.at("fn"),
                           json.at("tn"), json.at("ignored"), json.at("unknown_ids")};
    row.truth_hash = truth_hash_from(json.value("truth_hash", ""), file);
  }
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
std::string dump(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

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

/// What a killed run left, or one that is about to be replaced.
bool is_leftover(const std::filesystem::path& folder) {
  return folder.extension() == ".partial" || folder.extension() == ".replaced";
}

}  // namespace

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
    const bool of_scans = it->path().filename() == "labels" || it->path().filename() == "scores";
    if (of_scans || is_leftover(it->path())) {
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
    result.content = in_present_format(ordered_json::parse(read_file(file)), file);
    for (const ordered_json& row : result.content.at("scans")) {
      result.rows.scans.push_back(row_from_json(row, file));
    }
    result.rows.fingerprint = result.content.value("fingerprint", "");
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
