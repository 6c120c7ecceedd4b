#include "eval/cli/checkup_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "eval/results/answer_text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::string ranges_text(const SequenceCheckup& sequence) {
  std::size_t returns = 0;
  for (const std::size_t points : sequence.points_of_range) returns += points;
  std::string text;
  double from_m = 0.0;
  for (std::size_t bin = 0; bin < sequence.points_of_range.size(); ++bin) {
    const double share = returns == 0 ? 0.0
                                      : 100.0 * static_cast<double>(sequence.points_of_range[bin]) /
                                            static_cast<double>(returns);
    const bool last = bin + 1 == sequence.points_of_range.size();
    text += fmt::format("{}{:g}{} m {:.1f} %", text.empty() ? "" : ", ", from_m,
                        last ? "+" : fmt::format("-{:g}", range_bins_m()[bin]), share);
    from_m = range_bins_m()[bin];
  }
  return text;
}

std::string ids_text(const SequenceCheckup& sequence) {
  std::string text;
  for (const auto& [id, points] : sequence.points_of_id) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", id, points);
  }
  return text.empty() ? "none read" : text;
}

std::string poses_text(const SequenceCheckup& sequence) {
  if (!sequence.poses) return "  overlap         not measured: too few scans or points\n";
  const PoseMeasurement& measured = *sequence.poses;
  std::string text = fmt::format(
      "  overlap         {:.2f} as given, {:.2f} after moving scans by {:.2f} m (median)\n",
      measured.given.overlap, measured.given.best_overlap, measured.given.median_correction_m);
  for (std::size_t i = 0; i < measured.scores.size(); ++i) {
    const ConventionScore& score = measured.scores[i];
    const std::string what = score.pairs == 0 ? "cannot be decided from these scans"
                                              : fmt::format("{:.2f} against {:.2f} as given",
                                                            score.overlap, score.given_overlap);
    text += fmt::format("                  {}, if the poses were {}\n", what,
                        sequence.conventions[i].name);
  }
  return text;
}

std::string sequence_text(const SequenceCheckup& sequence) {
  std::string text =
      fmt::format("{}: {} scans, {} labelled, {} read\n", sequence.name, sequence.scans,
                  sequence.labelled_scans,
                  sequence.scans_read + (sequence.poses ? sequence.poses->scans_read : 0));
  for (const auto& [what, how] : sequence.reading) text += fmt::format("  {:<16}{}\n", what, how);
  for (const std::string& remark : sequence.remarks)
    text += fmt::format("  note            {}\n", remark);
  text += fmt::format("  returns         {} of {} points; {} NaN or infinite\n",
                      sequence.points - sequence.zero_points - sequence.nonfinite_points,
                      sequence.points, sequence.nonfinite_points);
  text += fmt::format("  range           {}\n  label ids       {}\n", ranges_text(sequence),
                      ids_text(sequence));
  return text + poses_text(sequence);
}

std::string verdict(const Checkup& checkup, const std::string& input) {
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
  return "Verdict: nothing wrong was found. Next\n  mosbench run " + input + "\n";
}

const char* severity_text(Severity severity) {
  return severity == Severity::kError ? "error" : "warning";
}

ordered_json to_json(const SequenceCheckup& sequence) {
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
                       {"poses", nullptr}};
  for (const auto& [what, how] : sequence.reading) json["reading"][what] = how;
  for (const auto& [id, points] : sequence.points_of_id) {
    json["label_ids"][std::to_string(id)] = points;
  }
  if (!sequence.poses) return json;
  ordered_json poses = {{"overlap", sequence.poses->given.overlap},
                        {"best_overlap", sequence.poses->given.best_overlap},
                        {"median_correction_m", sequence.poses->given.median_correction_m},
                        {"conventions", ordered_json::array()}};
  for (std::size_t i = 0; i < sequence.poses->scores.size(); ++i) {
    const ConventionScore& score = sequence.poses->scores[i];
    poses["conventions"].push_back({{"name", sequence.conventions[i].name},
                                    {"pairs", score.pairs},
                                    {"pairs_better", score.pairs_better},
                                    {"overlap", score.overlap},
                                    {"given_overlap", score.given_overlap}});
  }
  json["poses"] = poses;
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
                       {"sequences", ordered_json::array()},
                       {"symptoms", ordered_json::array()}};
  if (checkup.kind) json["dataset"] = std::string(to_string(*checkup.kind));
  for (const SequenceCheckup& sequence : checkup.sequences) {
    json["sequences"].push_back(to_json(sequence));
  }
  for (const Symptom& symptom : checkup.symptoms) {
    json["symptoms"].push_back({{"severity", severity_text(symptom.severity)},
                                {"where", symptom.where},
                                {"what", symptom.what}});
  }
  return json_text(json);
}

}  // namespace mosbench
