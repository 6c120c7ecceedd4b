#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "datasets/sequence/sequence_name.hpp"
#include "eval/answer/answer.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/protocols/scan_sums.hpp"
#include "eval/results/result_file.hpp"

namespace mosbench {

/// What a result.json says about one sequence, whoever predicted its labels.
struct SequenceResult {
  std::filesystem::path file;
  nlohmann::ordered_json header;  ///< all of the file but scans and timing
  SequenceName sequence;
  std::string dataset;
  std::string method;   ///< its title: "HMM-MOS"
  std::string setting;  ///< of the method, in words: "paper-2024, voxel 0.2 m, ..."
  const Protocol* protocol = nullptr;
  RangeGate range;
  std::optional<std::string> fingerprint;  ///< of the frames; nothing when only labels were read
  std::string fingerprint_without_poses;   ///< empty where it is not known
  bool simulated = false;
  std::string simulated_origin;           ///< "scene mall, seed 1"
  std::size_t missing_predictions = 0;    ///< scans left out under --allow-missing
  std::optional<std::string> only_split;  ///< whose scans alone were scored, not the protocol's own
  std::map<std::string, std::set<std::string>> splits;  ///< stems, of splits that pick scans
  std::vector<ScanRow> scans;
  std::optional<double> method_ms_per_scan;
  std::optional<double> most_resident_mib;  ///< of the process after a scan
  std::optional<unsigned> threads;          ///< that the method was run with
  std::string processor = "unknown";
};

/// Sequences scored by the same rules with labels from one method and setting.
struct ResultSet {
  std::filesystem::path path;             ///< file or folder it was read from
  std::vector<SequenceResult> sequences;  ///< at least one, by name
  const SequenceResult& front() const { return sequences.front(); }
};

/// What the content of `file` says. Throws DataError naming it.
SequenceResult sequence_result(const std::filesystem::path& file, ResultFile content);
/// Reads one result.json. Throws DataError naming it.
SequenceResult read_sequence_result(const std::filesystem::path& file);

/// Sorts results into runs: what differs in method, setting, protocol, range or data set is another
/// run. Throws DataError when a run has the same sequence twice. `path` is what they were read
/// from.
std::vector<ResultSet> sorted_into_runs(std::vector<SequenceResult> results,
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

/// The scans that the protocol counts, in order: those with truth, of the protocol's split where it
/// picks scans.
std::vector<const ScanRow*> counted_scans(const SequenceResult& result);
SequenceCounts counts_of(const SequenceResult& result);
std::vector<SequenceCounts> counts_of(const ResultSet& set);

}  // namespace mosbench
