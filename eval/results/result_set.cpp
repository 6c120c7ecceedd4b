#include "eval/results/result_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/results/settings_json.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using nlohmann::ordered_json;

/// Results of `mosbench run` hold the settings themselves, those of `mosbench score` what the user
/// calls them.
void read_method(const ordered_json& header, SequenceResult& result) {
  const ordered_json& method = header.at("method");
  result.method = method.at("name");
  if (method.contains("setting")) {
    result.setting = method.at("setting").get<std::string>();
    return;
  }
  const auto kind = method.at("kind").get<std::string>();
  try {
    check_recorded_settings(header.at("config"), kind);
  } catch (const std::invalid_argument& error) {
    throw DataError(fmt::format("{}: config: {}", result.file.string(), error.what()));
  }
  result.setting = describe_settings(header.at("config"), kind);
}

void read_protocol(const ordered_json& header, SequenceResult& result) {
  const ordered_json& protocol = header.at("protocol");
  result.protocol = find_protocol(protocol.at("name").get<std::string>());
  if (result.protocol == nullptr) {
    throw DataError(result.file, "names protocol " + protocol.at("name").dump(),
                    "one that `mosbench list protocols` shows");
  }
  result.range = {protocol.at("min_range_m"), protocol.at("max_range_m")};
}

void read_splits(const ordered_json& header, SequenceResult& result) {
  if (const ordered_json split = header.value("summary_split", ordered_json()); !split.is_null()) {
    if (split != std::string(result.protocol->default_split)) {
      result.only_split = split.get<std::string>();
    }
  }
  if (!header.contains("splits")) return;
  for (const auto& [name, stems] : header.at("splits").items()) {
    result.splits[name] = stems.get<std::set<std::string>>();
  }
}

/// Throws DataError where a summary is not that of the scans, as in a file that was edited.
void check_summary(const SequenceResult& result) {
  const ordered_json summary = result.header.value("summary", ordered_json());
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

/// Results of `mosbench score` cost nothing.
void read_cost(const ResultFile& content, SequenceResult& result) {
  result.method_ms_per_scan = method_ms_per_scan(content.rows);
  for (const ScanCost& cost : content.rows.costs) {
    result.most_resident_mib = std::max(result.most_resident_mib, std::optional(cost.resident_mib));
  }
  if (!content.content.contains("timing")) return;
  const ordered_json& timing = content.content.at("timing");
  if (timing.contains("threads")) result.threads = timing.at("threads").get<unsigned>();
}

SequenceResult from_content(const fs::path& file, ResultFile content) {
  SequenceResult result;
  result.file = file;
  result.scans = std::move(content.rows.scans);
  read_cost(content, result);
  result.header = std::move(content.content);
  result.header.erase("scans");
  result.header.erase("timing");
  result.header.erase("source");
  const ordered_json& header = result.header;
  result.sequence = SequenceName(header.at("sequence"), file);
  result.dataset = header.at("dataset");
  read_method(header, result);
  read_protocol(header, result);
  read_splits(header, result);
  check_summary(result);
  if (!content.rows.fingerprint.empty()) result.fingerprint = content.rows.fingerprint;
  result.fingerprint_without_poses = content.rows.fingerprint_without_poses;
  result.simulated = header.contains("simulated");
  if (result.simulated) {
    const ordered_json& origin = header.at("simulated");
    result.simulated_origin =
        fmt::format("scene {}, seed {}", origin.at("scene").get<std::string>(),
                    origin.at("seed").get<std::uint64_t>());
  }
  if (header.contains("machine")) {
    result.processor = header.at("machine").value("processor", result.processor);
  }
  if (header.contains("predictions")) {
    result.missing_predictions = header.at("predictions").at("missing").size();
  }
  return result;
}

/// Settings of the odometry that found the poses; nothing for those that were given.
ordered_json odometry_of(const SequenceResult& result) {
  const ordered_json reading = result.header.value("reading", ordered_json::object());
  ordered_json odometry;
  for (const char* name : {"pose_odometry", "pose_map"}) odometry[name] = reading.value(name, "");
  if (reading.contains("pose_odometry")) odometry["poses"] = reading.at("poses");
  return odometry;
}

bool same_run(const SequenceResult& a, const SequenceResult& b) {
  return a.dataset == b.dataset && a.method == b.method && a.setting == b.setting &&
         a.protocol == b.protocol && a.range == b.range && odometry_of(a) == odometry_of(b) &&
         a.header.value("config", ordered_json()) == b.header.value("config", ordered_json());
}

void add_to_runs(SequenceResult result, std::vector<ResultSet>& sets, const fs::path& path) {
  const auto set = std::ranges::find_if(
      sets, [&](const ResultSet& known) { return same_run(known.front(), result); });
  if (set == sets.end()) {
    sets.push_back({path, {std::move(result)}});
    return;
  }
  const auto twin = std::ranges::find(set->sequences, result.sequence, &SequenceResult::sequence);
  if (twin != set->sequences.end()) {
    throw DataError(result.file,
                    "scores sequence " + result.sequence.text() + " like " + twin->file.string(),
                    "one result per sequence of a run");
  }
  set->sequences.push_back(std::move(result));
}

/// Whether two runs have the same sequence.
bool has_twins(const std::vector<ResultSet>& runs) {
  std::set<SequenceName> names;
  for (const ResultSet& run : runs) {
    for (const SequenceResult& sequence : run.sequences) {
      if (!names.insert(sequence.sequence).second) return true;
    }
  }
  return false;
}

/// One run of several, as jobs of a cluster leave a folder each.
ResultSet joined(std::vector<ResultSet> runs) {
  ResultSet whole = std::move(runs.front());
  for (std::size_t i = 1; i < runs.size(); ++i) {
    std::ranges::move(runs[i].sequences, std::back_inserter(whole.sequences));
  }
  std::ranges::sort(whole.sequences, {}, &SequenceResult::sequence);
  return whole;
}

/// The folders to give instead of the one that holds them all: ": one of a, b"; nothing where runs
/// share a folder.
std::string folders_text(const std::vector<ResultSet>& sets) {
  std::set<std::string> folders;
  for (const ResultSet& set : sets) {
    folders.insert(folder_of_run(set.front().file.parent_path(), set.front().sequence).string());
  }
  return folders.size() < sets.size() ? "" : fmt::format(": one of {}", fmt::join(folders, ", "));
}

/// Names the file and what tells its run from others.
std::string run_text(const SequenceResult& result) {
  return fmt::format("{} ({}; {}; {})", result.file.string(), result.method, result.setting,
                     result.protocol->name);
}

}  // namespace

SequenceResult sequence_result(const fs::path& file, ResultFile content) {
  try {
    return from_content(file, std::move(content));
  } catch (const ordered_json::exception& error) {
    throw DataError(file, error.what(), "a result.json of mosbench");
  }
}

SequenceResult read_sequence_result(const fs::path& file) {
  return sequence_result(file, read_result(file));
}

std::vector<ResultSet> sorted_into_runs(std::vector<SequenceResult> results, const fs::path& path) {
  std::vector<ResultSet> sets;
  for (SequenceResult& result : results) add_to_runs(std::move(result), sets, path);
  for (ResultSet& set : sets) std::ranges::sort(set.sequences, {}, &SequenceResult::sequence);
  return sets;
}

std::vector<ResultSet> load_result_sets(const fs::path& path) {
  std::vector<SequenceResult> results;
  for (const fs::path& file : result_files(path)) results.push_back(read_sequence_result(file));
  return sorted_into_runs(std::move(results), path);
}

std::vector<ResultSet> load_runs_of_folders(const fs::path& path) {
  std::map<fs::path, std::vector<SequenceResult>> places;
  for (const fs::path& file : result_files(path)) {
    SequenceResult result = read_sequence_result(file);
    const fs::path folder = folder_of_run(file.parent_path(), result.sequence);
    places[folder].push_back(std::move(result));
  }
  std::vector<std::vector<ResultSet>> of_setting;
  for (auto& [folder, results] : places) {
    for (ResultSet& run : sorted_into_runs(std::move(results), path)) {
      const auto known = std::ranges::find_if(of_setting, [&](const auto& runs) {
        return same_run(runs.front().front(), run.front());
      });
      auto& runs = known == of_setting.end() ? of_setting.emplace_back() : *known;
      runs.push_back(std::move(run));
    }
  }
  std::vector<ResultSet> all;
  for (std::vector<ResultSet>& runs : of_setting) {
    if (!has_twins(runs)) runs = {joined(std::move(runs))};
    std::ranges::move(runs, std::back_inserter(all));
  }
  return all;
}

ResultSet load_result_set(const fs::path& path) {
  std::vector<ResultSet> sets = load_result_sets(path);
  if (sets.size() == 1) return std::move(sets.front());
  throw DataError(path,
                  fmt::format("holds {} runs: {} differs from {}", sets.size(),
                              run_text(sets[1].front()), run_text(sets[0].front())),
                  "the results of one run" + folders_text(sets));
}

fs::path folder_of_run(const fs::path& result_folder, const SequenceName& sequence) {
  fs::path run = result_folder;
  fs::path rest = sequence.folder();
  while (!rest.empty() && run.filename() == rest.filename()) {
    run = run.parent_path();
    rest = rest.parent_path();
  }
  return rest.empty() && run.has_filename() ? run : result_folder;
}

std::size_t missing_predictions(const ResultSet& set) {
  std::size_t missing = 0;
  for (const SequenceResult& sequence : set.sequences) missing += sequence.missing_predictions;
  return missing;
}

std::string incomplete_warning(std::size_t missing_predictions) {
  return fmt::format("INCOMPLETE: {} not counted",
                     counted(missing_predictions, "scan without usable prediction is",
                             "scans without usable prediction are"));
}

std::string split_warning(const std::string& split) {
  return fmt::format(
      "only the scans of split {}: not the protocol's number, which is over all labelled scans",
      split);
}

std::vector<std::string> warnings(const ResultSet& set) {
  std::vector<std::string> texts;
  if (const std::size_t missing = missing_predictions(set); missing > 0) {
    texts.push_back(incomplete_warning(missing));
  }
  const auto partial = std::ranges::find_if(set.sequences, [](const SequenceResult& sequence) {
    return sequence.only_split.has_value();
  });
  if (partial != set.sequences.end()) texts.push_back(split_warning(*partial->only_split));
  return texts;
}

Standing standing_of(const ResultSet& set) {
  Standing standing{.doubts = warnings(set)};
  for (const SequenceResult& sequence : set.sequences) {
    standing.simulated = standing.simulated || sequence.simulated;
    if (standing.origin.empty()) standing.origin = sequence.simulated_origin;
  }
  return standing;
}

Standing standing_of(const ResultSet& first, const char* first_name, const ResultSet& second,
                     const char* second_name) {
  Standing both{standing_of(first).simulated || standing_of(second).simulated};
  for (const auto& [set, name] : {std::pair{&first, first_name}, std::pair{&second, second_name}}) {
    for (const std::string& doubt : warnings(*set)) {
      both.doubts.push_back(fmt::format("{}: {}", name, doubt));
    }
  }
  return both;
}

std::vector<const ScanRow*> counted_scans(const SequenceResult& result) {
  const auto split = result.splits.find(std::string(result.protocol->default_split));
  std::vector<const ScanRow*> scans;
  for (const ScanRow& row : result.scans) {
    if (!row.counts) continue;
    if (split == result.splits.end() || split->second.contains(row.stem)) scans.push_back(&row);
  }
  return scans;
}

SequenceCounts counts_of(const SequenceResult& result) {
  SequenceCounts counts;
  for (const ScanRow* row : counted_scans(result)) counts.push_back(*row->counts);
  return counts;
}

std::vector<SequenceCounts> counts_of(const ResultSet& set) {
  std::vector<SequenceCounts> counts;
  for (const SequenceResult& result : set.sequences) counts.push_back(counts_of(result));
  return counts;
}

}  // namespace mosbench
