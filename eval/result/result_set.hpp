#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

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

std::vector<SequenceCounts> counts_of(const ResultSet& set);

}  // namespace mosbench
