#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/sequence/reading.hpp"
#include "datasets/sequence/sequence.hpp"
#include "eval/answer/answer.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {

/// What a run found out about one scan. Depends on nothing but the input, the configuration and the
/// code.
struct ScanRow {
  std::string stem;
  std::size_t points = 0;
  std::size_t predicted_moving_points = 0;
  std::size_t nonfinite_points = 0;
  bool judged = true;  ///< false: the method labelled all points static without looking
  std::optional<double> threshold;      ///< see LabelledScan
  std::optional<Confusion> counts;      ///< when the scan has truth
  std::optional<LabelHash> truth_hash;  ///< of that truth; older files do not tell
  std::optional<LabelHash> label_hash;  ///< of the labels that a run wrote; likewise
};

/// What one scan cost: wall milliseconds, and the memory the process held after it.
struct ScanCost {
  /// Spent waiting for the scan; with several threads it is read and observed ahead.
  double read_ms = 0.0;
  double push_ms = 0.0;           ///< the whole method, also what is done beside the scan before
  std::vector<double> stages_ms;  ///< as Timing::stages; those after its end are 0
  double resident_mib = 0.0;
};

/// What depends on the clock.
struct Timing {
  unsigned threads = 0;  ///< that the method was run with; 0 in results that do not tell
  double wall_s = 0.0;
  std::optional<double> core_s = std::nullopt;          ///< that a core was taken, poses included
  std::optional<double> program_cpu_s = std::nullopt;   ///< CPU of a user's program, and of ours
  std::optional<double> calibration_ms = std::nullopt;  ///< of the machine, see `calibration_ms`
  std::vector<std::string> stages;  ///< names, in the order in which they first ran
  std::vector<ScanCost> costs;      ///< as many as scans
};

/// Settings of the odometry that found the poses.
struct OdometryDone {
  std::string name;
  RecordedSettings settings;
  std::string map;  ///< what its map leaves out; empty for nothing
  bool operator==(const OdometryDone&) const = default;
};

/// A file that the command of a program of the user names, as it was.
struct ProgramFile {
  std::filesystem::path path;
  std::uint64_t bytes = 0;
  std::string hash;  ///< see `hash_of_file`
};

/// What made a result, and of what.
struct Provenance {
  std::string version, compiler;  ///< of mosbench
  std::optional<Machine> machine;
  std::string fingerprint;                ///< of the frames; empty when only labels were read
  std::string fingerprint_without_poses;  ///< empty where it is not known
  std::string program;  ///< hash of `program_files`; empty where they are not known
  std::vector<ProgramFile> program_files;  ///< those that a user's command names
  ReadingMembers reading;                  ///< how the sequence was read
  std::optional<OdometryDone> odometry;
  std::optional<SimulatedOrigin> simulated;  ///< its layout and scans are not recorded
};

/// The labels of another program that were scored.
struct ScoredPredictions {
  std::string format;
  bool guessed = false;
  std::string path;
  std::vector<std::string> missing;  ///< stems of scans left out under --allow-missing
  std::vector<std::string> remarks;
};

/// Where predictions lie and how they are read.
struct PredictionSource {
  std::filesystem::path path;  ///< a folder, or a file for a whole sequence
  PredictionOptions options;
};

/// Where on this machine data and labels lie, and the flags by which they were read.
struct Places {
  std::optional<std::filesystem::path> dataset_root;
  Reading reading;
  std::optional<PredictionSource> predictions;  ///< of `mosbench score`
  std::string file_stamp;                       ///< of the sequence's files, see `file_stamp`
  std::vector<std::string> sequences_of_run;    ///< by which an interrupted run is known
};

/// Why a result was accepted as a baseline, and on which day (UTC): "2026-01-31".
struct Acceptance {
  std::string why, on;
  bool operator==(const Acceptance&) const = default;
};

/// What a run cost.
struct RunCost {
  std::optional<double> core_ms_per_scan{};  ///< CPU; older versions did not take that of programs
  std::optional<double> calibration_ms;      ///< of the machine
  double most_resident_mib = 0.0;
  std::uint64_t bytes_written = 0;          ///< beside result.json
  std::optional<Machine> machine{};         ///< older results do not tell
  std::vector<std::string> what_written{};  ///< "labels", "scores"; likewise
};

/// A pose that odometry does not trust.
struct DoubtfulPose {
  std::string stem, doubt;
};

/// What is known of one sequence, whoever predicted its labels: the content of a result.json.
struct Result {
  std::filesystem::path file;  ///< that it was read from
  std::string key;             ///< of the question, in a store that has keys
  SequenceName sequence;
  std::string dataset;
  std::string method;   ///< its title: "HMM-MOS"
  std::string kind;     ///< its name: "hmm-mos"; empty where the labels are of others
  std::string setting;  ///< of the method, in words: "paper-2024, voxel 0.2 m, ..."
  std::optional<RecordedSettings> settings;  ///< of a run
  std::string preset;
  std::string settings_from;  ///< a preset file, and what it was tuned on; empty for none
  const Protocol* protocol = nullptr;
  RangeGate range;
  Provenance from;
  std::optional<ScoredPredictions> predictions;         ///< of `mosbench score`
  std::map<std::string, std::set<std::string>> splits;  ///< stems, of splits that pick scans
  std::optional<std::string> summary_split;  ///< whose scans the summary is over; else all scans
  std::vector<ScanRow> scans;
  std::vector<std::string> remarks, doubts;                 ///< as of a Recording
  std::vector<std::string> scans_left_out;                  ///< those without a pose
  std::optional<std::vector<DoubtfulPose>> doubtful_poses;  ///< of a run with odometry
  std::optional<Timing> timing;        ///< neither of scored labels nor of accepted results
  std::optional<Places> places;        ///< not of accepted results
  std::optional<RunCost> cost;         ///< of accepted results, see `run_cost`
  std::optional<Acceptance> accepted;  ///< of those for which somebody said why
  bool has_whole_scores = false;       ///< its .score files hold int32, as in format 1

  std::filesystem::path folder() const { return file.parent_path(); }
  bool is_simulated() const { return from.simulated.has_value(); }
  std::size_t missing_predictions() const { return predictions ? predictions->missing.size() : 0; }
};

/// Returns whether labels are those that the row of a run counts.
bool are_labels_of(const ScanRow& row, std::span<const std::uint32_t> labels);

/// Adds the times of a scan's stages to `cost`, and their names to `timing`.
void add_stages(const std::vector<StageTime>& stages, Timing& timing, ScanCost& cost);

/// Mean of ScanCost::push_ms; nothing without scans that were timed.
std::optional<double> method_ms_per_scan(const Result& result);
/// Most memory that the process held after a scan.
std::optional<double> most_resident_mib(const Result& result);

/// Returns what the run of a result cost, or the one that was accepted; nothing where nobody timed
/// it. Looks at the files of the run.
std::optional<RunCost> run_cost(const Result& result);

/// "HMM-MOS, paper-2024", or the method alone where no setting is known.
std::string method_words(const Result& result);

/// The split whose scans alone were scored where that is not the protocol's own.
std::optional<std::string> only_split(const Result& result);

/// What --perturb said of the scans; empty where they were read as they are.
std::string disturbance_of(const Result& result);
/// Returns what the result states of its reading under this name; empty where it states nothing.
std::string reading_statement(const Result& result, std::string_view name);
/// Which simulation its scans are of; empty for real data.
std::string simulation_of(const Result& result);

/// The scans that the protocol counts, in order: those with truth, of the protocol's split where it
/// picks scans.
std::vector<const ScanRow*> counted_scans(const Result& result);
SequenceCounts counts_of(const Result& result);

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

std::size_t missing_predictions(std::span<const Result> sequences);

/// "INCOMPLETE: ..." for so many scans.
std::string incomplete_warning(std::size_t missing_predictions);
/// "only the scans of split val, ...".
std::string split_warning(const std::string& split);
/// What makes the numbers of a result doubtful: what was found in its data, labels that the
/// protocol does not know, one class alone in the truth, poses that odometry does not trust.
std::vector<std::string> doubts_of(const Result& result);

/// Returns the doubt about so many poses, some of which odometry does not trust; empty for none.
std::string doubt_about(const std::vector<DoubtfulPose>& doubtful, std::size_t poses);
/// Returns the run whose folder of labels these predictions are; nothing for others.
std::optional<Result> run_that_wrote(const OpenedPredictions& opened);
/// Returns what makes labels of a run doubtful on these scans, whoever scores them: what was found
/// in its data, settings and poses.
std::vector<std::string> doubts_of_labels(const Result& run, const Sequence& sequence);

/// What has to be said wherever numbers of one result are shown: which scans are not counted, and
/// doubts.
std::vector<std::string> notices_of(const Result& result);

/// Returns the first file of the program that made a result that holds something else by now;
/// nothing where it is gone, as on another machine, and
/// of an accepted result.
std::optional<std::filesystem::path> changed_program_file(const Result& result);
/// Throws DataError for results whose program has changed since, unless they are allowed: then
/// their doubts say so.
void refuse_stale(const std::vector<ResultSet>& sets, bool allowed);

/// A sentence about a sequence or run.
struct Doubt {
  std::string about, what;
};
/// Returns a line per sentence, after the names of all that it is about: "00, 01 and 3 more: ...".
std::vector<std::string> told(const std::vector<Doubt>& doubts);
/// The same with one line for sentences that differ in their numbers alone, see `say_by_kind`.
std::vector<std::string> told_by_kind(std::vector<Doubt> doubts);

/// Which scans of the protocol are not counted: without predictions, of other splits.
std::vector<std::string> shortfalls(std::span<const Result> sequences);
/// What has to be said wherever numbers of the set are shown: shortfalls and doubts.
std::vector<std::string> warnings(const ResultSet& set);

/// Returns the sequences of these names, all where there are none. Throws DataError for a name that
/// the set does not have.
ResultSet only(ResultSet set, const std::vector<std::string>& names);

/// What every format has to show beside numbers of the set.
Standing standing_of(const ResultSet& set);
/// The same beside those of each sequence alone, and last those of the set: looks at the files of
/// each once.
std::vector<Standing> standings_of(const ResultSet& set);
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

/// What made the first simulated sequence of a data set; nothing for recorded data.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// What every format has to show beside numbers of a data set, with doubts about its labels.
Standing standing_of(const Dataset& dataset, std::vector<Doubt> doubts = {});

/// Says how the label files of a run are not those that its result counts, by their number and
/// sizes. Nothing for a result without label files.
std::optional<std::string> changed_labels(const Result& result);

/// Returns the mark of the data that a result is of.
DataMark mark_of(const Result& result);

/// Where poses lie, and their mark.
struct NamedMark {
  std::string place;
  PoseMark mark;
};
/// The same of numbers that are of all these poses.
Standing standing_of(std::span<const NamedMark> marks);

}  // namespace mosbench
