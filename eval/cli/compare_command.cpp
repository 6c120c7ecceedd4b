#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/breakdown/run_diff.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/output.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/tell.hpp"
#include "eval/statistics/run_statistics.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

/// Two runs, and what `mosbench compare` does with them.
struct CompareFlags {
  std::filesystem::path baseline, newer;
  double max_drop_points = 0.5;
  std::optional<double> max_added_false_positives;
  bool statistical = false, even_if = false, quiet = false, accept = false, allow_stale = false;
  std::vector<std::string> by;
  std::optional<std::filesystem::path> data;
  std::string dataset = "auto";
  std::size_t top = 10;
  std::filesystem::path out, summary;

  bool shows(std::string_view what) const { return std::ranges::find(by, what) != by.end(); }
};

Answer answer_of(const ResultSet& baseline, const ResultSet& newer, const PairedRuns& paired,
                 const GateResult& result) {
  const std::string unlike = unlike_text(paired.unlike);
  Sheet sheet = gate_sheet(result);
  sheet.lead.push_back(fmt::format("{} paired scans", paired.scans.size()));
  if (!unlike.empty()) sheet.lead.push_back("unlike: " + unlike);
  nlohmann::ordered_json json = to_json(result);
  json["paired_scans"] = paired.scans.size();
  json["missing_predictions"] = {{"baseline", missing_predictions(baseline)},
                                 {"new", missing_predictions(newer)}};
  json["unlike"] = unlike;
  return {.exit_code = result.passed() ? 0 : 1,
          .standing = standing_of(baseline, "baseline", newer, "new"),
          .sheets = {std::move(sheet)},
          .json = json_text(json),
          .checks = gate_checks(result)};
}

void check_shares_scans(const PairedRuns& paired, const CompareFlags& options) {
  if (!paired.scans.empty()) return;
  throw DataError(options.newer, "shares no counted scan with " + options.baseline.string(),
                  "results over the same scans");
}

Answer compare(const CompareFlags& options) {
  const Format written = format_of_name(options.out).value_or(Format::kMarkdown);
  if (!options.out.empty()) check_output(options.out, written);
  if (!options.summary.empty()) check_output(options.summary, Format::kMarkdown);
  const ResultSet baseline = load_result_set(options.baseline);
  const ResultSet newer = load_result_set(options.newer);
  refuse_stale({newer}, options.allow_stale);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.newer,
                    "is not like " + options.baseline.string() + ": " + unlike_text(paired.unlike),
                    "results of the same kind; --even-if compares them anyway");
  }
  check_shares_scans(paired, options);
  const GateResult result =
      judge(paired, *baseline.front().protocol,
            {options.max_drop_points / 100.0,
             options.statistical ? GateRule::kStatistical : GateRule::kMaxDrop,
             options.max_added_false_positives});
  Answer answer = answer_of(baseline, newer, paired, result);
  if (!options.out.empty()) {
    write_output(options.out, render(answer, written));
    answer = answer_beside(options.out, std::move(answer));
  }
  if (!options.summary.empty()) {
    append_output(options.summary, render(answer, Format::kMarkdown));
  }
  return options.quiet && result.passed() ? Answer{} : answer;
}

/// Returns what the new run changes, paired scan by scan. Throws DataError unless both are under
/// one protocol, over the same scans and truth.
Answer paired_difference(const CompareFlags& options) {
  const ResultSet first = load_result_set(options.baseline);
  const ResultSet second = load_result_set(options.newer);
  PairedRuns paired = pair_runs(first, second);
  std::erase_if(paired.unlike,
                [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kSetting; });
  std::vector<Unlike> refused = paired.unlike;
  std::erase_if(refused, [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kPoses; });
  if (!refused.empty()) {
    throw DataError(second.path, "is not like " + first.path.string() + ": " + unlike_text(refused),
                    "the same protocol, scans and truth");
  }
  return difference_answer(first, second, paired);
}

/// Labels of a run for the scans of another one, found by their stems.
class LabelsByStem : public Predictions {
 public:
  LabelsByStem(const ResultScans& run, const Sequence& sequence) : run_(run), sequence_(sequence) {
    for (std::size_t k = 0; k < run.sequence().size(); ++k) scans_[run.sequence().stem(k)] = k;
  }
  bool has(std::size_t scan_index) const override {
    const auto scan = scans_.find(sequence_.stem(scan_index));
    return scan != scans_.end() && run_.has(scan->second);
  }
  std::vector<std::uint32_t> read(std::size_t scan_index) const override {
    return run_.labels().read(scans_.at(sequence_.stem(scan_index)));
  }

 private:
  const ResultScans& run_;
  const Sequence& sequence_;
  std::map<std::string, std::size_t> scans_;
};

[[noreturn]] void refuse_scan(const ResultScans& run, const char* why, const std::string& stem) {
  throw DataError(
      run.result().file,
      fmt::format("has {} for scan {} of sequence {}", why, stem, run.result().sequence.text()),
      "runs over the same scans and truth, to list objects of");
}

/// Returns the counted scans of the first run. Throws DataError unless their truth is what both
/// runs were scored by, and the second has labels of them.
std::vector<std::size_t> scans_of(const ResultScans& first, const Predictions& second,
                                  const Result& result) {
  std::set<std::string> counted;
  for (const ScanRow* row : counted_scans(result)) counted.insert(row->stem);
  std::vector<std::size_t> scans;
  for (const std::size_t k : first.scored_scans()) {
    const ScanRow& row = first.rows()[k];
    if (!counted.contains(row.stem)) continue;
    if (row.truth_hash && hash_of_labels(first.sequence().read_truth(k)) != row.truth_hash) {
      refuse_scan(first, "another truth", row.stem);
    }
    if (!second.has(k)) refuse_scan(first, "labels that the other run lacks", row.stem);
    scans.push_back(k);
  }
  return scans;
}

/// Both runs are broken down over the scans as the first one read them, with its poses.
std::vector<ObjectDisagreement> objects_of(const Result& first, const Result& second,
                                           const std::filesystem::path& root) {
  const ResultScans scans(first, root);
  const ResultScans others(second, root);
  const LabelsByStem labels(others, scans.sequence());
  const std::vector<std::size_t> counted = scans_of(scans, labels, first);
  const BreakdownTask task{first.protocol, first.range, hardware_threads()};
  return disagreeing_objects(break_down(scans.sequence(), counted, scans.labels(), task),
                             break_down(scans.sequence(), counted, labels, task));
}

std::vector<ObjectDisagreement> objects_of(const CompareFlags& options, const ResultSet& first,
                                           const ResultSet& second) {
  std::optional<DatasetKind> kind = dataset_kind_option(options.dataset);
  std::set<std::string> there;
  for (const SequenceFolder& found : find_sequences(*options.data, {kind}, kind)) {
    there.insert(found.name);
  }
  std::vector<ObjectDisagreement> objects;
  bool any = false;
  for (const Result& result : first.sequences) {
    const auto other = std::ranges::find(second.sequences, result.sequence, &Result::sequence);
    if (counted_scans(result).empty() || other == second.sequences.end()) continue;
    if (!there.contains(result.sequence)) {
      tell(fmt::format("{}: has no sequence {}; its objects are left out", options.data->string(),
                       result.sequence.text()));
      continue;
    }
    any = true;
    std::ranges::move(objects_of(result, *other, *options.data), std::back_inserter(objects));
  }
  if (any) return objects;
  throw DataError(*options.data, "has none of the sequences that both runs hold",
                  "the data set of the runs in --data");
}

/// Without truth there are no right and wrong points to compare.
void check_has_truth(const ResultSet& run) {
  const bool scored = std::ranges::any_of(
      run.sequences, [](const Result& sequence) { return !counted_scans(sequence).empty(); });
  if (scored) return;
  throw DataError(run.front().file, "has no scan with truth, by which points are right or wrong",
                  "a run over labelled scans; the colour disagreement of mosbench report shows "
                  "where labels differ without truth");
}

/// Returns the scans and, with --data, the objects on which the runs disagree.
Answer scans_and_objects(const CompareFlags& options) {
  const ResultSet first = load_result_set(options.baseline);
  const ResultSet second = load_result_set(options.newer);
  for (const ResultSet* run : {&first, &second}) check_has_truth(*run);
  const PairedRuns paired = pair_runs(first, second);
  check_shares_scans(paired, options);
  const auto objects = options.shows("object") && options.data ? objects_of(options, first, second)
                                                               : std::vector<ObjectDisagreement>{};
  return {.standing = standing_of(first, "first", second, "second"),
          .sheets = diff_sheets(options.baseline, options.newer, paired, objects, options.top),
          .json = json_text(diff_json(paired, objects, options.top))};
}

/// Says what changes against the baseline before.
Answer change(const CompareFlags& options, const ResultSet& newer) {
  const std::vector<ResultSet> known = accepted_runs(options.baseline);
  if (known.empty()) {
    return {.standing = standing_of(newer), .sheets = {{.lead = {"a new baseline"}}}};
  }
  if (known.size() > 1 && options.even_if) return {"several runs were there before\n"};
  // Of several runs, loading one names what they differ in.
  const ResultSet baseline = known.size() == 1 ? known.front() : load_result_set(options.baseline);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.baseline,
                    "is a baseline of another kind than " + options.newer.string() + ": " +
                        unlike_text(paired.unlike),
                    "one of the same kind; --even-if replaces it anyway");
  }
  if (paired.scans.empty()) return {"no scan in common with the baseline before\n"};
  return difference_answer(baseline, newer, paired);
}

/// Makes the new run the baseline and returns what that changes.
Answer accepted(const CompareFlags& options) {
  const ResultSet newer = load_result_set(options.newer);
  refuse_stale({newer}, options.allow_stale);
  refuse_overlap(newer, options.baseline);
  restore_folder(resolved(options.baseline));
  const FolderLock lock(options.baseline);
  Answer answer = change(options, newer);
  accept_baseline(newer, options.baseline);
  answer.text +=
      fmt::format("accepted {} as {}\n", options.newer.string(), options.baseline.string());
  return answer;
}

Answer answer(const CompareFlags& options) {
  if (options.accept) return accepted(options);
  if (options.by.empty()) return compare(options);
  if (!options.shows("sequence")) return scans_and_objects(options);
  if (options.by.size() == 1) return paired_difference(options);
  throw UsageError("--by sequence: goes with nothing else, expected it alone, or scan,object");
}

}  // namespace

CommandRun add_compare(CLI::App& command) {
  auto options = std::make_shared<CompareFlags>();
  add(command, "BASELINE DIR", options->baseline, "Accepted results")->required();
  add(command, "NEW DIR", options->newer, "Results to judge")->required();
  add(command, "--max-drop", options->max_drop_points, "Percentage points of IoU that may be lost")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  add(command, "--max-added-fp", options->max_added_false_positives,
      "False positives per scan that may be added (default: 10 where nothing moves, any number "
      "elsewhere)")
      ->check(CLI::NonNegativeNumber);
  command.add_flag("--statistical", options->statistical,
                   "Fail only when the drop also exceeds what its 95 % interval leaves open");
  command.add_flag("--even-if", options->even_if, "Also compare results of different kinds");
  add_stale_flag(command, options->allow_stale);
  add_list(command, "--by WHAT,...", options->by,
           "Judge nothing and show what NEW changes in each sequence (also of another method "
           "or setting), or on which scans and objects the two disagree")
      ->check(CLI::IsMember({"sequence", "scan", "object"}));
  add(command, "--data DIR", options->data, "Data set of both, for --by object");
  add_dataset_kind_flag(command, options->dataset)->group(kRareGroup);
  add(command, "--top", options->top, "How many scans and objects --by lists")
      ->capture_default_str();
  command.add_flag("--accept", options->accept, "Make NEW the baseline and show what changes");
  add(command, "-o,--out FILE", options->out,
      "Also write the table to FILE, as its name ends: .md, .html, .json, or .xml for JUnit");
  add(command, "--summary FILE", options->summary, "Also append the table in markdown to FILE");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing when it passes");
  return [options] { return answer(*options); };
}

}  // namespace mosbench
