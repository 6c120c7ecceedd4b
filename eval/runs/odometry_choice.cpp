#include "eval/runs/odometry_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/files/errors.hpp"
#include "datasets/files/nearest_name.hpp"
#include "datasets/sequence/posed_sequence.hpp"
#include "eval/results/settings_json.hpp"

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

}  // namespace

OdometryChoice choose_odometry(const OdometryOptions& options) {
  const std::string name = options.kind.value_or(std::string(odometries().front().name));
  OdometryChoice choice{.kind = &row_named(odometries(), name, "--odometry"), .settings = {}};
  choice.settings = choice.kind->defaults;
  if (options.preset) apply_odometry_preset(*options.preset, *choice.kind, choice.settings);
  if (options.config_file) apply_settings_file(*options.config_file, choice.settings);
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

ReadingStatement statement_of(const OdometryChoice& choice) {
  std::vector<std::string> settings;
  for (const Setting& setting : choice.settings.all()) {
    settings.push_back(fmt::format("{}={}", setting.name, to_string(setting.value)));
  }
  return {{"poses", fmt::format("odometry {}", choice.kind->name)},
          {"pose_odometry", fmt::format("{}", fmt::join(settings, " "))}};
}

void expect_poses(Dataset& dataset, const OdometryChoice& choice) {
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    sequence = std::make_unique<PosedSequence>(std::move(sequence), statement_of(choice));
  }
}

std::vector<ScanPose> estimate_poses(const Sequence& sequence, const OdometryChoice& choice,
                                     unsigned threads, const std::function<void()>& advance) {
  const std::unique_ptr<Odometry> odometry = choice.kind->make(choice.settings, threads);
  std::vector<ScanPose> poses;
  Frame frame;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    sequence.read(k, frame);
    poses.push_back(odometry->push(frame.points, {frame.stamp_ns, frame.point_times_ns}));
    advance();
  }
  return poses;
}

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans) {
  std::vector<Pose> poses;
  for (const ScanPose& scan : scans) poses.push_back(scan.map_from_sensor);
  return poses;
}

std::size_t doubtful_count(const std::vector<ScanPose>& scans) {
  return static_cast<std::size_t>(std::ranges::count_if(scans, &ScanPose::doubtful));
}

std::string odometry_remark(const Sequence& sequence, const OdometryChoice& choice,
                            const std::vector<ScanPose>& scans) {
  std::string remark = fmt::format("poses found by {}", choice.kind->title);
  const auto first = std::ranges::find_if(scans, &ScanPose::doubtful);
  if (first == scans.end()) return remark;
  const auto k = static_cast<std::size_t>(first - scans.begin());
  return remark + fmt::format("; {} of {} are doubtful, first that of scan {}: {}",
                              doubtful_count(scans), scans.size(), sequence.stem(k), first->doubt);
}

}  // namespace mosbench
