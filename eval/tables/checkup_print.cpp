#include "eval/tables/checkup_print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Returns the bins of which anything is seen at the precision that is printed.
std::string ranges_text(const SequenceCheckup& sequence) {
  std::size_t returns = 0;
  for (const std::size_t points : sequence.points_of_range) returns += points;
  std::vector<std::string> bins;
  double from_m = 0.0;
  for (std::size_t bin = 0; bin < sequence.points_of_range.size(); ++bin) {
    const double share = returns == 0 ? 0.0
                                      : 100.0 * static_cast<double>(sequence.points_of_range[bin]) /
                                            static_cast<double>(returns);
    const bool last = bin + 1 == sequence.points_of_range.size();
    constexpr double kShown = 0.05;
    if (share >= kShown) {
      bins.push_back(fmt::format("{:g}{} m {:.1f} %", from_m,
                                 last ? "+" : fmt::format("-{:g}", range_bins_m()[bin]), share));
    }
    from_m = range_bins_m()[bin];
  }
  return bins.empty() ? "no returns" : fmt::format("{}", fmt::join(bins, ", "));
}

std::string ids_text(const SequenceCheckup& sequence) {
  std::string text;
  for (const auto& [id, points] : sequence.points_of_id) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", id, points);
  }
  return text.empty() ? "none read" : text;
}

/// Returns whether the measured motions contradict one another.
bool cannot_be_told(const PoseEvidence& poses) { return poses.disagreement > 1.0; }

std::string names_text(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 3;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(kShown, names.size()));
  std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + shown, "; "));
  if (names.size() > kShown) text += fmt::format("; and {} more", names.size() - kShown);
  return text;
}

/// Says how near the nearest other convention comes, and which ones no motion tells apart.
std::string conventions_text(const PoseEvidence& poses) {
  std::vector<std::string> not_told;
  std::size_t tried = 0, nearest = 0;
  for (std::size_t i = 0; i < poses.scores.size(); ++i) {
    if (std::abs(poses.conventions[i].rows_later) > 1) continue;
    if (poses.scores[i].pairs == 0) {
      not_told.push_back(poses.conventions[i].name);
    } else if (++tried == 1 || poses.scores[i].off_m < poses.scores[nearest].off_m) {
      nearest = i;
    }
  }
  std::string text;
  if (tried > 0) {
    text += fmt::format(
        "  conventions     {} others tried: the nearest ({}) is {:.2f} m off the scans' motion, "
        "the given one {:.2f} m\n",
        tried, poses.conventions[nearest].name, poses.scores[nearest].off_m,
        poses.scores[nearest].given_off_m);
  }
  if (!not_told.empty()) {
    text += fmt::format("  not checked     {} (the same motions here)\n", names_text(not_told));
  }
  return text;
}

std::string poses_text(const SequenceCheckup& sequence) {
  if (!sequence.has_poses) return "";
  if (!sequence.poses) {
    return fmt::format(
        "  overlap         not measured: {}\n",
        sequence.is_partly_turned ? "the scans do not fit one another" : "too few scans or points");
  }
  const PoseEvidence& poses = *sequence.poses;
  std::string text = fmt::format(
      "  overlap         {:.2f} as given, {:.2f} after moving scans by {:.2f} m (median over {} "
      "scans)\n",
      poses.overlap, poses.best_overlap, poses.median_correction_m, poses.measured.scans_read);
  if (sequence.facts.number("places")) {
    text += sequence.facts.told(
        "  fit             over {fit_scans} surfaces are {fit_10_cm:.1f} cm off at 10 m, "
        "{fit_30_cm:.1f} cm at 30 m (scan matching errs by {match_cm:.1f} cm)\n");
  }
  text += conventions_text(poses);
  if (cannot_be_told(poses)) {
    text +=
        "                  scans overlap too little to measure their motion well: small faults "
        "cannot be told\n";
  }
  return text;
}

std::string labels_text(const SequenceCheckup& sequence) {
  if (!sequence.labels || sequence.labels->moving == 0) return "";
  return fmt::format(
      "  moving labels   {:.0f} % of their points leave their place within a second, {:.1f} % of "
      "the static ones\n",
      100.0 * sequence.labels->moving_leaves, 100.0 * sequence.labels->still_leaves);
}

std::string sequence_text(const SequenceCheckup& sequence) {
  std::string text = fmt::format("{}: {}, {} labelled\n", sequence.name,
                                 counted(sequence.scans, "scan"), sequence.labelled_scans);
  for (const auto& [what, how] : members_of(sequence.reading))
    text += fmt::format("  {:<16}{}\n", what, how);
  for (const std::string& remark : sequence.remarks)
    text += fmt::format("  note            {}\n", remark);
  text += fmt::format("  returns         {} of {} in {}; {} NaN or infinite\n",
                      sequence.points - sequence.zero_points - sequence.nonfinite_points,
                      counted(sequence.points, "point"), counted(sequence.scans_read, "scan"),
                      sequence.nonfinite_points);
  text += fmt::format("  range           {}\n  label ids       {}\n", ranges_text(sequence),
                      ids_text(sequence));
  return text + poses_text(sequence) + labels_text(sequence);
}

/// Says of which sequences the poses were not checked; empty where all were.
std::string unchecked_text(const Checkup& checkup) {
  std::vector<std::string> names;
  for (const SequenceCheckup& sequence : checkup.sequences) {
    if (!sequence.poses) names.push_back(sequence.name);
  }
  if (names.empty()) return "";
  return fmt::format("; the poses of {} were NOT checked: too few scans or points",
                     names_text(names));
}

std::string verdict(const Checkup& checkup, const std::string& input) {
  if (checkup.lacks_poses) {
    return fmt::format(
        "Verdict: has no poses yet{}. Find them from the scans, and run it, by\n  mosbench run {} "
        "--odometry simple\n",
        checkup.has(Severity::kWarning) ? ", and is doubtful until the warnings are understood"
                                        : "",
        input);
  }
  if (checkup.has(Severity::kError)) {
    return "Verdict: cannot be used as it is. Put right the errors above, then\n  mosbench "
           "doctor " +
           input + "\n";
  }
  if (checkup.has(Severity::kWarning)) {
    return "Verdict: can be run, but its numbers are doubtful until the warnings are understood. "
           "Then\n  mosbench run " +
           input + "\n";
  }
  const bool unsure = std::ranges::any_of(checkup.sequences, [](const SequenceCheckup& sequence) {
    return sequence.poses && !sequence.poses->fits() && cannot_be_told(*sequence.poses) &&
           sequence.poses->overlap < sequence.poses->best_overlap;
  });
  return fmt::format("Verdict: nothing wrong was found{}{}. Next\n  mosbench run {}\n",
                     unsure ? "; whether the poses fit cannot be told from these scans" : "",
                     unchecked_text(checkup), input);
}

const char* severity_text(Severity severity) {
  return severity == Severity::kError ? "error" : "warning";
}

ordered_json checkup_json(const SequenceCheckup& sequence) {
  ordered_json json = {{"name", sequence.name},
                       {"scans", sequence.scans},
                       {"labelled_scans", sequence.labelled_scans},
                       {"points_read", sequence.points},
                       {"zero_points", sequence.zero_points},
                       {"nonfinite_points", sequence.nonfinite_points},
                       {"reading", ordered_json::object()},
                       {"remarks", sequence.remarks},
                       {"label_ids", ordered_json::object()},
                       {"points_of_range", sequence.points_of_range},
                       {"poses", nullptr},
                       {"truth", nullptr}};
  for (const auto& [what, how] : members_of(sequence.reading)) json["reading"][what] = how;
  for (const auto& [id, points] : sequence.points_of_id) {
    json["label_ids"][std::to_string(id)] = points;
  }
  json["measures"] = ordered_json::object();
  for (const Check& check : checks()) {
    for (const Limit& limit : check.limits) {
      if (const auto number = sequence.facts.number(limit.fact)) {
        json["measures"][limit.fact] = *number;
      }
    }
  }
  if (!sequence.poses) return json;
  ordered_json poses = {{"overlap", sequence.poses->overlap},
                        {"best_overlap", sequence.poses->best_overlap},
                        {"median_correction_m", sequence.poses->median_correction_m},
                        {"unsound", sequence.poses->deviation},
                        {"disagreement", sequence.poses->disagreement},
                        {"conventions", ordered_json::array()}};
  for (std::size_t i = 0; i < sequence.poses->scores.size(); ++i) {
    const ConventionScore& score = sequence.poses->scores[i];
    poses["conventions"].push_back({{"name", sequence.poses->conventions[i].name},
                                    {"pairs", score.pairs},
                                    {"gain", score.gain},
                                    {"off_m", score.off_m},
                                    {"given_off_m", score.given_off_m}});
  }
  json["poses"] = poses;
  if (!sequence.labels) return json;
  json["truth"] = {{"moving_points", sequence.labels->moving},
                   {"static_points", sequence.labels->still},
                   {"moving_leaves", sequence.labels->moving_leaves},
                   {"static_leaves", sequence.labels->still_leaves},
                   {"purity", sequence.labels->purity}};
  return json;
}

}  // namespace

std::string checkup_text(const Checkup& checkup, const std::string& input) {
  std::string text;
  if (checkup.kind) text += fmt::format("{} data set\n\n", to_string(*checkup.kind));
  for (const SequenceCheckup& sequence : checkup.sequences) text += sequence_text(sequence) + '\n';
  for (const Symptom& symptom : checkup.symptoms) {
    text +=
        fmt::format("{}: {}: {}\n", severity_text(symptom.severity), symptom.where, symptom.what);
  }
  if (!checkup.symptoms.empty()) text += '\n';
  return text + verdict(checkup, input);
}

std::string checkup_json(const Checkup& checkup) {
  ordered_json json = {{"dataset", nullptr},
                       {"range_bins_m", range_bins_m()},
                       {"sequences", ordered_json::array()},
                       {"symptoms", ordered_json::array()},
                       {"thresholds", ordered_json::array()}};
  json["range_bins_m"].back() = nullptr;  // open
  if (checkup.kind) json["dataset"] = std::string(to_string(*checkup.kind));
  for (const SequenceCheckup& sequence : checkup.sequences) {
    json["sequences"].push_back(checkup_json(sequence));
  }
  for (const Symptom& symptom : checkup.symptoms) {
    json["symptoms"].push_back({{"severity", severity_text(symptom.severity)},
                                {"where", symptom.where},
                                {"what", symptom.what}});
  }
  for (const Check& check : checks()) {
    for (const Limit& limit : check.limits) {
      json["thresholds"].push_back({{"check", check.name},
                                    {"measure", limit.fact},
                                    {"faulty", limit.faulty == '>' ? "above" : "below"},
                                    {"threshold", limit.threshold}});
    }
  }
  return json_text(json);
}

}  // namespace mosbench
