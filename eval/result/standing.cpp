#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNamedAtMost = 3;

std::string words_of(const SimulatedOrigin& origin) {
  return fmt::format("scene {}, seed {}{}", origin.scene, origin.seed,
                     origin.perturb ? ", disturbed by " + *origin.perturb : "");
}

/// Says each origin once, in their order.
Standing with_origins(Standing standing, const std::vector<std::string>& origins) {
  std::vector<std::string> said;
  for (const std::string& origin : origins) {
    if (std::ranges::find(said, origin) == said.end()) said.push_back(origin);
  }
  standing.simulated = !said.empty();
  standing.origin = fmt::format("{}", fmt::join(said, "; "));
  return standing;
}

void add_origins(std::span<const Result> sequences, std::vector<std::string>& origins) {
  for (const Result& sequence : sequences) {
    if (sequence.from.simulated) origins.push_back(words_of(*sequence.from.simulated));
  }
}

/// The first simulated sequence's.
const SimulatedOrigin* origin_of(const Dataset& dataset) {
  for (const std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    if (sequence->simulated()) return &*sequence->simulated();
  }
  return nullptr;
}

/// "00", "00, 01 and 02", "00, 01, 02 and 4 more".
std::string names_text(const std::vector<std::string>& names) {
  const bool all = names.size() <= kNamedAtMost;
  const std::size_t listed = all ? names.size() - 1 : kNamedAtMost;
  if (listed == 0) return names.front();
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(listed);
  return fmt::format("{} and {}", fmt::join(names.begin(), end, ", "),
                     all ? names.back() : fmt::format("{} more", names.size() - listed));
}

void add_doubts_of_truth(const Result& result, std::vector<std::string>& doubts) {
  const SequenceCounts counts = counts_of(result);
  Confusion all;
  for (const Confusion& scan : counts) all += scan;
  if (auto unknown = unknown_ids_remark(*result.protocol, all.unknown_ids); !unknown.empty()) {
    doubts.push_back(std::move(unknown));
  }
  const auto moving = all.tp + all.fn, still = all.tn + all.fp;
  if (moving + still == 0 || (moving > 0 && still > 0)) return;
  doubts.push_back(fmt::format("by the truth no counted point of {} {}",
                               counted(counts.size(), "scan"),
                               moving == 0 ? "moves: an IoU is 0 or undefined" : "stands still"));
}

std::string stale_doubt(const Result& result) {
  if (!result.places) return "";
  if (const auto changed = changed_program_file(result)) {
    return fmt::format("STALE: {} has changed since", changed->string());
  }
  for (const ProgramFile& file : result.from.program_files) {
    if (is_there(file.path)) continue;
    return fmt::format("nobody can tell whether it is stale: {} is not there", file.path.string());
  }
  return "";
}

void add_once(std::string doubt, std::vector<std::string>& doubts) {
  const bool is_new = std::ranges::find(doubts, doubt) == doubts.end();
  if (!doubt.empty() && is_new) doubts.push_back(std::move(doubt));
}

/// Adds those about poses that were found, and about scans that were not judged.
void add_doubts_of_method(const Result& result, std::vector<std::string>& doubts) {
  const auto& doubtful = result.doubtful_poses;
  if (doubtful) add_once(doubt_about(*doubtful, result.scans.size()), doubts);
  if (!result.scans.empty() && std::ranges::none_of(result.scans, &ScanRow::judged)) {
    doubts.push_back(fmt::format("all {} labelled static without detection",
                                 counted(result.scans.size(), "scan is", "scans are")));
  }
}

}  // namespace

std::size_t missing_predictions(std::span<const Result> sequences) {
  std::size_t missing = 0;
  for (const Result& sequence : sequences) missing += sequence.missing_predictions();
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

std::string doubt_about(const std::vector<DoubtfulPose>& doubtful, std::size_t poses) {
  if (doubtful.empty()) return "";
  const auto& [stem, doubt] = doubtful.front();
  return fmt::format("{} of {} found are doubtful, first that of scan {}: {}", doubtful.size(),
                     counted(poses, "pose"), stem, doubt);
}

std::vector<std::string> doubts_of(const Result& result) {
  std::vector<std::string> doubts = result.doubts;
  // Older results do not say it among their doubts.
  add_once(disturbed_doubt(mark_of(result)), doubts);
  add_once(changed_labels(result).value_or(""), doubts);
  add_once(stale_doubt(result), doubts);
  add_doubts_of_truth(result, doubts);
  add_doubts_of_method(result, doubts);
  return doubts;
}

std::optional<Result> run_that_wrote(const OpenedPredictions& opened) {
  std::error_code ignored;
  const fs::path labels = fs::weakly_canonical(opened.path, ignored);
  const bool may_be = opened.format == PredictionFormat::kLabel && labels.filename() == "labels";
  if (!may_be) return std::nullopt;
  const fs::path file = labels.parent_path() / "result.json";
  try {
    if (!is_there(file)) return std::nullopt;
    Result run = read_result(file);
    if (!run.predictions) return run;
  } catch (const DataError&) {  // of another program
  }
  return std::nullopt;
}

std::vector<std::string> doubts_of_labels(const Result& run, const Sequence& sequence) {
  std::vector<std::string> doubts = run.doubts;
  add_once(stale_doubt(run), doubts);
  add_doubts_of_method(run, doubts);
  const auto& perturb = sequence.reading().perturb;
  const std::string labelled = disturbance_of(run), now = perturb ? to_string(*perturb) : "";
  if (labelled == now) return doubts;
  const auto text = [](const std::string& disturbance) {
    return disturbance.empty() ? std::string("not disturbed") : "disturbed by " + disturbance;
  };
  doubts.push_back(
      fmt::format("the scans that were labelled are {}, those read now are {}: the same --perturb "
                  "makes them agree",
                  text(labelled), text(now)));
  return doubts;
}

std::optional<std::string> changed_labels(const Result& result) {
  const fs::path folder = result.folder() / "labels";
  std::error_code error;
  if (result.predictions || !fs::is_directory(folder, error)) return std::nullopt;
  std::size_t lost = 0, other = 0;
  std::string first_other;
  for (const ScanRow& row : result.scans) {
    const std::string name = row.stem + ".label";
    const std::uintmax_t bytes = fs::file_size(folder / name, error);
    if (error) {
      ++lost;
    } else if (bytes != row.points * sizeof(std::uint32_t) && other++ == 0) {
      first_other = fmt::format(", first {} with {} for {} points", name,
                                counted(bytes / sizeof(std::uint32_t), "label"), row.points);
    }
  }
  if (lost + other == 0) return std::nullopt;
  return fmt::format("LABELS CHANGED after the run: of {} {} are gone and {} of another size{}",
                     counted(result.scans.size(), "label file"), lost, other, first_other);
}

DataMark mark_of(const Result& result) {
  DataMark mark{result.from.simulated, ""};
  const auto said = std::ranges::find_if(
      result.doubts, [](const std::string& doubt) { return doubt.starts_with(kDisturbedDoubt); });
  if (said != result.doubts.end()) {
    mark.disturbed = said->substr(kDisturbedDoubt.size());
    return mark;
  }
  if (mark.simulated) mark.disturbed = mark.simulated->perturb.value_or("");
  for (const auto& [name, value] : result.from.reading) {
    if (name == "perturb") mark = disturbed_by(std::move(mark), value);
  }
  return mark;
}

std::optional<fs::path> changed_program_file(const Result& result) {
  // An accepted result is there to be compared with what its program becomes.
  if (!result.places) return std::nullopt;
  for (const ProgramFile& file : result.from.program_files) {
    std::error_code gone;
    const std::uintmax_t bytes = fs::file_size(file.path, gone);
    if (!gone && (bytes != file.bytes || hash_of_file(file.path) != file.hash)) return file.path;
  }
  return std::nullopt;
}

void refuse_stale(const std::vector<ResultSet>& sets, bool allowed) {
  if (allowed) return;
  for (const ResultSet& set : sets) {
    for (const Result& sequence : set.sequences) {
      const auto changed = changed_program_file(sequence);
      if (!changed) continue;
      throw DataError(sequence.file,
                      "is stale: its program has changed since, " + changed->string(),
                      "mosbench run again, which computes it anew; --allow-stale shows it anyway");
    }
  }
}

std::vector<std::string> told(const std::vector<Doubt>& doubts) {
  std::vector<std::pair<std::string, std::vector<std::string>>> about_same;
  for (const Doubt& doubt : doubts) {
    auto same =
        std::ranges::find(about_same, doubt.what, [](const auto& each) { return each.first; });
    if (same == about_same.end()) same = about_same.insert(same, {doubt.what, {}});
    same->second.push_back(doubt.about);
  }
  std::vector<std::string> lines;
  for (const auto& [what, names] : about_same) lines.push_back(names_text(names) + ": " + what);
  return lines;
}

std::vector<std::string> told_by_kind(std::vector<Doubt> doubts) {
  std::vector<std::string*> sentences;
  for (Doubt& doubt : doubts) sentences.push_back(&doubt.what);
  say_by_kind(sentences);
  return told(doubts);
}

namespace {

std::vector<std::string> shortfalls(std::size_t missing, const std::optional<std::string>& split) {
  std::vector<std::string> texts;
  if (missing > 0) texts.push_back(incomplete_warning(missing));
  if (split) texts.push_back(split_warning(*split));
  return texts;
}

}  // namespace

std::vector<std::string> notices_of(const Result& result) {
  std::vector<std::string> texts = shortfalls(result.missing_predictions(), only_split(result));
  std::ranges::move(doubts_of(result), std::back_inserter(texts));
  return texts;
}

std::vector<std::string> shortfalls(std::span<const Result> sequences) {
  const auto with_split = std::ranges::find_if(
      sequences, [](const Result& sequence) { return only_split(sequence).has_value(); });
  return shortfalls(missing_predictions(sequences),
                    with_split != sequences.end() ? only_split(*with_split) : std::nullopt);
}

ResultSet only(ResultSet set, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const bool is_there = std::ranges::any_of(
        set.sequences, [&](const Result& result) { return result.sequence.text() == name; });
    if (is_there) continue;
    std::vector<std::string> there;
    for (const Result& result : set.sequences) there.push_back(result.sequence.text());
    throw DataError(set.path, "has no sequence " + name, names_text(there));
  }
  std::erase_if(set.sequences, [&](const Result& result) {
    return !names.empty() && std::ranges::find(names, result.sequence.text()) == names.end();
  });
  return set;
}

std::vector<std::string> warnings(const ResultSet& set) { return standing_of(set).doubts; }

std::vector<Standing> standings_of(const ResultSet& set) {
  const auto standing_with = [](std::span<const Result> sequences,
                                const std::vector<Doubt>& doubts) {
    std::vector<std::string> texts = shortfalls(sequences), origins;
    std::ranges::move(told(doubts), std::back_inserter(texts));
    add_origins(sequences, origins);
    return with_origins({.doubts = std::move(texts)}, origins);
  };
  std::vector<Standing> standings;
  std::vector<Doubt> all;
  for (const Result& sequence : set.sequences) {
    std::vector<Doubt> own;
    for (const std::string& doubt : doubts_of(sequence)) {
      own.push_back({sequence.sequence.text(), doubt});
    }
    standings.push_back(standing_with({&sequence, 1}, own));
    std::ranges::move(own, std::back_inserter(all));
  }
  standings.push_back(standing_with(set.sequences, all));
  return standings;
}

Standing standing_of(const ResultSet& set) { return standings_of(set).back(); }

Standing standing_of(const ResultSet& first, const char* first_name, const ResultSet& second,
                     const char* second_name) {
  std::vector<Doubt> doubts;
  for (std::string& doubt : warnings(first)) doubts.push_back({first_name, std::move(doubt)});
  for (std::string& doubt : warnings(second)) doubts.push_back({second_name, std::move(doubt)});
  std::vector<std::string> origins;
  add_origins(first.sequences, origins);
  add_origins(second.sequences, origins);
  return with_origins({.doubts = told(doubts)}, origins);
}

std::string simulated_notice(const SimulatedOrigin& origin) {
  return fmt::format("simulated data ({}): not comparable with published numbers",
                     words_of(origin));
}

std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset) {
  const SimulatedOrigin* origin = origin_of(dataset);
  return origin != nullptr ? std::optional(to_json(*origin)) : std::nullopt;
}

Standing standing_of(const Dataset& dataset, std::vector<Doubt> doubts) {
  for (const std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    for (std::string& doubt : doubts_of(*sequence)) {
      const bool is_said = std::ranges::any_of(doubts, [&](const Doubt& one) {
        return one.about == sequence->name() && one.what == doubt;
      });
      if (!is_said) doubts.push_back({sequence->name(), std::move(doubt)});
    }
  }
  std::vector<std::string> origins;
  for (const std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    if (sequence->simulated()) origins.push_back(words_of(*sequence->simulated()));
  }
  return with_origins({.doubts = told(doubts)}, origins);
}

Standing standing_of(std::span<const NamedMark> marks) {
  std::vector<std::string> origins;
  std::vector<Doubt> doubts;
  for (const auto& [place, mark] : marks) {
    if (mark.simulated) origins.push_back(words_of(*mark.simulated));
    for (const std::string& doubt : mark.doubts) doubts.push_back({place, doubt});
  }
  return with_origins({.doubts = told(doubts)}, origins);
}

}  // namespace mosbench
