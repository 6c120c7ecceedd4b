#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sensor_guess.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/result.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

std::string time_text(const Recording& recording) {
  const std::optional<double> step_s = usual_step_s(recording.scans);
  if (!step_s) return "no stamps: windows in seconds count as at 10 Hz";
  const auto first_ns = recording.scans.front().stamp_ns, last_ns = recording.scans.back().stamp_ns;
  return fmt::format("{:.1f} Hz, {:.1f} s", 1.0 / *step_s,
                     1e-9 * static_cast<double>(*last_ns - *first_ns));
}

/// How far the sensor goes, and where the poses are from.
std::string way_text(const Sequence& sequence) {
  double way_m = 0.0;
  for (std::size_t k = 1; k < sequence.size(); ++k) {
    way_m +=
        (sequence.map_from_sensor(k).translation() - sequence.map_from_sensor(k - 1).translation())
            .norm();
  }
  const std::string& from = sequence.reading().poses.source;
  if (from == kNoPoses) return "not known: no poses";
  return fmt::format("{:.1f} m by {}", way_m, from.empty() ? "its own poses" : from);
}

/// One row a fact.
class InfoSheet {
 public:
  explicit InfoSheet(const Sequence& sequence) {
    sheet_.title = sequence.name();
    sheet_.columns = {{"what", Unit::kText}, {"value", Unit::kText}};
    add("scans",
        fmt::format("{}, {} with truth", sequence.size(), scans_with_truth(sequence).size()));
    add("time", time_text(sequence.recording()));
    add("way", way_text(sequence));
    add_sensor(sequence);
    for (const std::string& remark : sequence.remarks()) sheet_.notes.push_back(remark);
  }
  Sheet take() { return std::move(sheet_); }

 private:
  void add(const std::string& what, const std::string& value) {
    sheet_.rows.push_back({what, value});
  }

  /// By the scan in the middle.
  void add_sensor(const Sequence& sequence) {
    Frame frame;
    sequence.read(sequence.size() / 2, frame);
    const SensorGuess guess = guess_sensor(frame.points);
    add("points", fmt::format("{} in scan {}, {} of them missing returns", frame.points.size(),
                              sequence.size() / 2, guess.missing));
    if (guess.returns == 0) return;
    add("range", fmt::format("{:.1f} to {:.1f} m, half within {:.1f} m", guess.nearest_m,
                             guess.farthest_m, guess.median_m));
    add("field of view", fmt::format("{:.0f} degrees around, {:.1f} to {:.1f} degrees up{}",
                                     guess.around_deg, guess.lowest_deg, guess.highest_deg,
                                     guess.rings ? fmt::format(", {} rings", *guess.rings) : ""));
    const auto given = [](bool has) { return has ? "yes" : "no"; };
    add("fields",
        fmt::format("times of points: {}, radial velocities: {}, LiDARs: {}",
                    given(!frame.point_times_ns.empty()), given(!frame.radial_velocity_m_s.empty()),
                    std::max<std::size_t>(sequence.recording().lidars.size(), 1)));
  }

  Sheet sheet_;
};

/// Opens the data, with or without poses.
Dataset opened(DataWords words, std::string& missing) {
  try {
    return open_dataset(words);
  } catch (const MissingPoses& error) {
    missing = error.what();
    words.reading = without_poses(words.reading);
    return open_dataset(words);
  }
}

Answer info_answer(const DataWords& words) {
  const Data data = data_of(words);
  std::string missing_poses;
  const Dataset dataset = opened(words, missing_poses);
  Answer answer{.standing = standing_of(dataset)};
  for (const auto& sequence : dataset.sequences) {
    caller().at_each_scan();
    answer.sheets.push_back(InfoSheet(*sequence).take());
  }
  answer.sheets.front().lead = {fmt::format("{} data set, {}", to_string(dataset.kind),
                                            counted(dataset.sequences.size(), "sequence"))};
  std::vector<std::string>& notes = answer.sheets.back().notes;
  if (!missing_poses.empty()) notes.push_back(missing_poses);
  notes.push_back(
      fmt::format("next: `mosbench doctor {0}` checks it, `mosbench run {0}{1}` finds "
                  "what moves",
                  to_words(data), missing_poses.empty() ? "" : " --odometry simple"));
  return answer;
}

}  // namespace

CommandRun add_info(CLI::App& command) {
  auto words = std::make_shared<DataWords>();
  add_dataset_flags(command, *words);
  return [words] { return info_answer(*words); };
}

}  // namespace mosbench
