#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/pose_file.hpp"
#include "datasets/files/pose_list.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/method_options.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/progress.hpp"
#include "eval/results/settings_json.hpp"
#include "eval/runs/odometry_choice.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kOdometryFooter =
    R"(Finds the poses of the scans from the scans alone and writes them: rows of 12 numbers (KITTI), or
"stamp x y z qx qy qz qw" (TUM) if FILE ends in .tum or --format says so. The map frame is that of the
first scan. For several sequences FILE is a folder, and each is written to FILE/<sequence>.txt.

A pose is doubtful when registration was not possible, little of the scan overlaps the map, the surfaces
hardly constrain some motion (corridor, empty field), or the pose lies far off constant velocity.
Doubtful poses are written anyway, listed in the answer, and make the exit code 1.

Settings: defaults < --preset < --config FILE < --set, as for methods. --json prints them and, per scan,
the pose, its covariance (rotation in rad, then translation in m, map frame), condition, overlap and
doubt.

Examples:
  mosbench odometry ~/kitti/sequences/04 -o poses.txt --preset kitti-online
  mosbench odometry ~/folder-with-a-bag -o poses.tum --set min_range_m=1,max_range_m=60
  mosbench odometry ~/kitti/sequences/04 -o kiss.txt --odometry kiss --json > kiss.json
  mosbench trajectory poses.txt --truth truth.txt)";

struct OdometryFlags {
  std::filesystem::path input, out;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  ReadingOptions reading;
  OdometryOptions odometry;
  std::optional<std::string> format;
  unsigned threads = 0;
  bool json = false;
};

struct FoundPoses {
  const Sequence& sequence;
  std::filesystem::path file;
  std::vector<ScanPose> poses;
};

bool writes_tum(const OdometryFlags& flags) {
  return flags.format ? *flags.format == "tum" : flags.out.extension() == ".tum";
}

std::string tum_rows(const Sequence& sequence, const std::vector<ScanPose>& poses) {
  std::string rows;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto stamp_ns = sequence.stamp_ns(k);
    if (!stamp_ns) {
      throw UsageError(fmt::format("--format tum: the scans of {} have no stamps, expected kitti",
                                   sequence.name()));
    }
    const Pose& pose = poses[k].map_from_sensor;
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
    const bool negative = *stamp_ns < 0;
    const std::uint64_t ns =
        negative ? -static_cast<std::uint64_t>(*stamp_ns) : static_cast<std::uint64_t>(*stamp_ns);
    rows += fmt::format("{}{}.{:09} {} {} {} {} {} {} {}\n", negative ? "-" : "",
                        ns / 1'000'000'000, ns % 1'000'000'000, pose.translation().x(),
                        pose.translation().y(), pose.translation().z(), q.x(), q.y(), q.z(), q.w());
  }
  return rows;
}

FoundPoses find_poses(const Sequence& sequence, const std::filesystem::path& file,
                      const OdometryChoice& choice, const OdometryFlags& flags) {
  Progress progress(fmt::format("{} of {}", choice.kind->title, sequence.name()), sequence.size());
  const unsigned threads = flags.threads > 0 ? flags.threads : hardware_threads();
  FoundPoses found{sequence, file,
                   estimate_poses(sequence, choice, threads, [&progress] { progress.advance(); })};
  write_file_atomic(file, writes_tum(flags) ? tum_rows(sequence, found.poses)
                                            : format_poses(poses_of(found.poses)));
  return found;
}

std::string found_text(const FoundPoses& found, const OdometryChoice& choice) {
  constexpr std::size_t kListed = 10;
  const std::size_t doubtful = doubtful_count(found.poses);
  std::string text =
      fmt::format("{}: {} poses by {} in {}, {} doubtful\n", found.sequence.name(),
                  found.poses.size(), choice.kind->title, found.file.string(), doubtful);
  std::size_t listed = 0;
  for (std::size_t k = 0; k < found.poses.size() && listed < kListed; ++k) {
    if (!found.poses[k].doubtful()) continue;
    text += fmt::format("  scan {}: {}\n", found.sequence.stem(k), found.poses[k].doubt);
    ++listed;
  }
  if (doubtful > listed) text += fmt::format("  and {} more\n", doubtful - listed);
  return text;
}

template <typename Matrix>
nlohmann::ordered_json rows_json(const Matrix& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    nlohmann::ordered_json& row = rows.emplace_back(nlohmann::ordered_json::array());
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
  }
  return rows;
}

nlohmann::ordered_json found_json(const FoundPoses& found) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const ScanPose& pose = found.poses[k];
    scans.push_back({{"stem", found.sequence.stem(k)},
                     {"map_from_sensor", rows_json(pose.map_from_sensor.matrix().topRows<3>())},
                     {"covariance", rows_json(pose.covariance)},
                     {"geometry", pose.geometry},
                     {"condition", pose.condition},
                     {"overlap", pose.overlap},
                     {"registered_points", pose.registered_points},
                     {"doubt", pose.doubtful() ? nlohmann::ordered_json(pose.doubt) : nullptr}});
  }
  return {{"sequence", found.sequence.name()},
          {"file", found.file.string()},
          {"doubtful", doubtful_count(found.poses)},
          {"scans", scans}};
}

Answer odometry_answer(OdometryFlags flags) {
  const OdometryChoice choice = choose_odometry(flags.odometry);
  flags.reading.poses_by_odometry = true;
  const Dataset dataset = open_dataset(
      flags.input, {dataset_kind_option(flags.dataset), flags.sequences, flags.reading});
  std::string text;
  nlohmann::ordered_json sequences = nlohmann::ordered_json::array();
  std::size_t doubtful = 0;
  for (const auto& sequence : dataset.sequences) {
    const bool single = dataset.sequences.size() == 1;
    const std::filesystem::path file =
        single ? flags.out : flags.out / (sequence->name() + (writes_tum(flags) ? ".tum" : ".txt"));
    const FoundPoses found = find_poses(*sequence, file, choice, flags);
    doubtful += doubtful_count(found.poses);
    text += found_text(found, choice);
    if (flags.json) sequences.push_back(found_json(found));
  }
  if (flags.json) {
    text = json_text({{"odometry", std::string(choice.kind->name)},
                      {"settings", to_json(choice.settings)},
                      {"sequences", sequences}});
  }
  return {text, doubtful > 0 ? 1 : 0};
}

}  // namespace

CommandRun add_odometry(CLI::App& command) {
  auto flags = std::make_shared<OdometryFlags>();
  add_set_flag(command, flags->odometry.assignments);
  add_scan_dataset_flags(command, flags->input, flags->dataset, flags->sequences, flags->reading);
  command
      .add_option("-o,--out", flags->out, "File of poses to write; a folder for several sequences")
      ->type_name("FILE")
      ->required();
  command.add_option("--odometry", flags->odometry.kind, "simple or kiss (default: simple)");
  command.add_option("--preset", flags->odometry.preset, "Settings that authors published")
      ->type_name("PRESET");
  command.add_option("--config", flags->odometry.config_file, "JSON object of settings")
      ->type_name("FILE");
  command.add_option("--format", flags->format, "Of the file (default: by its name)")
      ->check(CLI::IsMember({"kitti", "tum"}));
  add_threads_flag(command, flags->threads);
  command.add_flag("--json", flags->json, "Print JSON instead of text");
  command.footer(kOdometryFooter);
  return [flags] { return odometry_answer(*flags); };
}

}  // namespace mosbench
