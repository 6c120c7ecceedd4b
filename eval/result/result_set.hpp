#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "eval/answer/answer.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// Sequences scored by the same rules with labels from one method and setting.
struct ResultSet {
  std::filesystem::path path;     ///< file or folder it was read from
  std::vector<Result> sequences;  ///< at least one, by name
  const Result& front() const { return sequences.front(); }
};

/// Sorts results into runs: what differs in method, setting, protocol, range or data set is another
/// run. Throws DataError when a run has the same sequence twice. `path` is what they were read
/// from.
std::vector<ResultSet> sorted_into_runs(std::vector<Result> results,
                                        const std::filesystem::path& path);

/// Every result.json below a folder (or the file itself), sorted into runs. Throws DataError when
/// there is none, or as `sorted_into_runs`.
std::vector<ResultSet> load_result_sets(const std::filesystem::path& path);

/// The same, except that results of one setting which have a sequence twice are a run per folder,
/// see `folder_of_run`.
std::vector<ResultSet> load_runs_of_folders(const std::filesystem::path& path);

/// Like load_result_sets where there has to be a single run; throws DataError naming two files that
/// differ, and the folders of all runs where they have one each.
ResultSet load_result_set(const std::filesystem::path& path);

/// Returns "runs/mine" for the result of sequence 00 in runs/mine/00; the folder itself where it is
/// not named like its sequence.
std::filesystem::path folder_of_run(const std::filesystem::path& result_folder,
                                    const SequenceName& sequence);

std::size_t missing_predictions(const ResultSet& set);

/// "INCOMPLETE: ..." for so many scans.
std::string incomplete_warning(std::size_t missing_predictions);
/// "only the scans of split val, ...".
std::string split_warning(const std::string& split);
/// What has to be said wherever numbers of the set are shown.
std::vector<std::string> warnings(const ResultSet& set);

/// What every format has to show beside numbers of the set.
Standing standing_of(const ResultSet& set);
/// The same of two sets, whose doubts begin with their names.
Standing standing_of(const ResultSet& first, const char* first_name, const ResultSet& second,
                     const char* second_name);

std::vector<SequenceCounts> counts_of(std::span<const Result> sequences);

/// How far counted scans are apart, by their names where these are numbers or stamps.
struct ScanGaps {
  double neighbours = 0;  ///< pairs of scans that follow each other
  double shared = 0;      ///< objects that both of a pair see, a part of 1 per pair
  ScanGaps& operator+=(const ScanGaps& other);
};
ScanGaps gaps_of(const Result& result);

/// "simulated data (scene mall, seed 1): not comparable with published numbers".
std::string simulated_notice(const SimulatedOrigin& origin);

/// What made a sequence that `mosbench simulate` wrote, also where a link leads to it; nothing for
/// real data.
std::optional<SimulatedOrigin> origin_of(const Dataset& dataset, const Sequence& sequence);
/// The same of the first such sequence of a data set.
std::optional<SimulatedOrigin> origin_of(const Dataset& dataset);
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// What every format has to show beside numbers of a data set.
Standing standing_of(const Dataset& dataset);

}  // namespace mosbench
