#include "eval/engine/odometry_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/sequence/posed_sequence.hpp"
#include "datasets/sequence/scan_deskewer.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"
#include "eval/engine/sequence_runner.hpp"
#include "eval/job/presets.hpp"
#include "eval/result/progress.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// The row of a table with that name. Throws UsageError with the nearest one.
template <typename Row>
const Row& row_named(std::span<const Row> rows, const std::string& name, const char* flag) {
  std::vector<std::string_view> names;
  for (const Row& row : rows) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  throw UsageError(fmt::format("{}: '{}' is not known, expected one of {} (nearest: {})", flag,
                               name, fmt::join(names, ", "), nearest_name(name, names)));
}

void apply_odometry_preset(const std::string& name, const OdometryKind& kind, Settings& settings) {
  const OdometryPreset& preset = row_named(odometry_presets(), name, "preset of odometry");
  if (preset.odometry != kind.name) {
    throw UsageError(fmt::format("preset of odometry: {} is of {}, expected one of {}", name,
                                 preset.odometry, kind.name));
  }
  for (const auto& [key, value] : preset.settings) settings.set(key, value);
}

std::string settings_text(const Settings& settings) {
  std::vector<std::string> words;
  for (const Setting& setting : settings.all()) {
    words.push_back(fmt::format("{}={}", setting.name, to_string(setting.value)));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

/// "poses found by SiMpLE", and how many of them are doubtful with the first; loudly where most
/// are.
std::string odometry_remark(const Sequence& sequence, const OdometryChoice& choice,
                            const std::vector<ScanPose>& scans) {
  std::string remark = fmt::format("poses found by {}", choice.kind->title);
  const auto first = std::ranges::find_if(scans, &ScanPose::doubtful);
  if (first == scans.end()) return remark;
  const auto k = static_cast<std::size_t>(first - scans.begin());
  const std::size_t doubtful = doubtful_count(scans);
  const char* loud = 2 * doubtful > scans.size()
                         ? "MOST POSES ARE DOUBTFUL, and labels made with them are, too: "
                         : "";
  return loud + remark +
         fmt::format("; {} of {} are doubtful, first that of scan {}: {}", doubtful, scans.size(),
                     sequence.stem(k), first->doubt);
}

/// Which points of a scan move, as seen from the pose that was just found.
std::vector<std::uint8_t> moving_points(Method& method, const MovingFilter& filter,
                                        const Sequence& sequence, std::size_t k,
                                        const Frame& frame) {
  const std::vector<LabelledScan> labelled = push_scan(method, sequence, k, frame);
  if (labelled.empty() || labelled.back().scan_index != k) {
    throw UsageError(fmt::format("drop_moving: {} labels scans later, expected an online method",
                                 filter.method->name));
  }
  std::vector<std::uint8_t> moving;
  for (const std::uint32_t label : labelled.back().labels) moving.push_back(label == kMovingLabel);
  return moving;
}

}  // namespace

bool OdometryOptions::says_anything() const {
  return preset || config_file || !assignments.empty() || drop_moving;
}

OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading) {
  const std::string name = options.kind.value_or(std::string(odometries().front().name));
  OdometryChoice choice{.kind = &row_named(odometries(), name, "--odometry"), .settings = {}};
  choice.settings = choice.kind->defaults;
  if (options.preset) apply_odometry_preset(*options.preset, *choice.kind, choice.settings);
  if (options.config_file) apply_settings_file(*options.config_file, choice.settings);
  if (reading.deskew) {
    choice.deskew = *reading.deskew;
    choice.says_deskew = true;
    choice.settings.set("deskew", std::string(to_string(choice.deskew)));
  }
  for (const std::string& assignment : options.assignments) {
    apply_setting_assignment(assignment, choice.settings);
  }
  try {
    choice.kind->check(choice.settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("odometry: {}", error.what()));
  }
  return choice;
}

std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading) {
  if (!odometry.kind) {
    if (!odometry.says_anything()) return std::nullopt;
    throw UsageError("--odometry: is missing, expected simple or kiss before its settings");
  }
  if (reading.pose_file() != nullptr) {
    throw UsageError("--poses and --odometry: say where poses come from, expected one of them");
  }
  return choose_odometry(odometry, reading);
}

MovingFilter moving_filter(const MethodKind& method, Settings settings) {
  if (settings.find(common_settings::kDelay_scans) != nullptr)
    settings.set(common_settings::kDelay_scans, 0);
  try {
    method.check(settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("drop_moving: needs method {} with delay_scans=0: {}", method.name,
                                 error.what()));
  }
  return {&method, std::move(settings)};
}

OdometryChoice with_filter(OdometryChoice choice, const OdometryOptions& options,
                           DatasetKind kind) {
  const MethodKind& method = default_method();
  if (options.drop_moving) {
    choice.filter = moving_filter(method, settings_of(default_preset(kind), method));
  }
  return choice;
}

OdometryDone odometry_done(const OdometryChoice& choice) {
  OdometryDone done{
      fmt::format("odometry {}", choice.kind->name), RecordedSettings(choice.settings), {}};
  if (choice.filter) {
    done.map = fmt::format("without what {} finds moving: {}", choice.filter->method->name,
                           settings_text(choice.filter->settings));
  }
  return done;
}

PosesDone statement_of(const OdometryChoice& choice) {
  const OdometryDone done = odometry_done(choice);
  return {.source = done.name, .odometry = settings_text(choice.settings), .map = done.map};
}

void expect_poses(Dataset& dataset, const OdometryChoice& choice) {
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = std::make_unique<PosedSequence>(std::move(sequence), statement_of(choice),
                                               choice.deskew, choice.says_deskew);
  }
}

std::vector<ScanPose> estimate_poses(const Sequence& sequence, const OdometryChoice& choice,
                                     unsigned threads, std::size_t most_scans) {
  const std::size_t scans = std::min(sequence.size(), most_scans);
  Progress progress(fmt::format("{} of {}", choice.kind->title, sequence.name()), scans);
  const std::unique_ptr<Odometry> odometry = choice.kind->make(choice.settings, threads);
  const auto& filter = choice.filter;
  const std::unique_ptr<Method> method =
      filter ? filter->method->make(filter->settings,
                                    {.threads = threads, .scan_count = sequence.size()})
             : nullptr;
  std::vector<ScanPose> poses;
  Frame frame;
  for (std::size_t k = 0; k < scans; ++k) {
    sequence.read(k, frame);
    poses.push_back(odometry->push(frame.points, {frame.stamp_ns, frame.point_times_ns}));
    if (method) {
      frame.map_from_sensor = poses.back().map_from_sensor;
      odometry->leave_out(moving_points(*method, *filter, sequence, k, frame));
    }
    progress.advance();
  }
  return poses;
}

std::vector<ScanPose> find_poses(const Sequence& sequence, const OdometryChoice& choice,
                                 unsigned threads) {
  const auto& posed = dynamic_cast<const PosedSequence&>(sequence);
  std::vector<ScanPose> scans = estimate_poses(posed.unposed(), choice, threads);
  tell(fmt::format("{}: {}", sequence.name(), odometry_remark(sequence, choice, scans)));
  return scans;
}

void set_poses(Sequence& sequence, const OdometryChoice& choice,
               const std::vector<ScanPose>& scans) {
  auto& posed = dynamic_cast<PosedSequence&>(sequence);
  posed.set_poses(poses_of(scans), odometry_remark(sequence, choice, scans));
}

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans) {
  std::vector<Pose> poses;
  for (const ScanPose& scan : scans) poses.push_back(scan.map_from_sensor);
  return poses;
}

std::size_t doubtful_count(const std::vector<ScanPose>& scans) {
  return static_cast<std::size_t>(std::ranges::count_if(scans, &ScanPose::doubtful));
}

}  // namespace mosbench
