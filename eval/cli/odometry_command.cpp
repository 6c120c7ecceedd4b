#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/thread_pool.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/pose_files.hpp"
#include "eval/result/output.hpp"
#include "eval/result/result.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

struct OdometryFlags : DataWords {
  PoseFiles files{.threads = hardware_threads()};
  OdometryOptions odometry;
};

/// FILE, or kitti:FILE or tum:FILE where its name does not say.
void take_out(const std::string& text, OdometryFlags& flags) {
  constexpr std::string_view kKitti = "kitti:", kTum = "tum:";
  const bool says_tum = text.starts_with(kTum), says_kitti = text.starts_with(kKitti);
  flags.files.out = text.substr(says_tum ? kTum.size() : says_kitti ? kKitti.size() : 0);
  flags.files.as_tum = says_tum || (!says_kitti && flags.files.out.extension() == ".tum");
}

/// The command that uses the poses: of the sensor itself, also where the layout's own are a
/// camera's.
std::string next_command(const OdometryFlags& flags) {
  Data data = data_of(flags);
  data.reading.poses = PoseFile{flags.files.out};
  // Poses that were refined would be disturbed once more.
  if (std::exchange(data.reading.refine_poses, false) && data.reading.perturb &&
      !changes_points_only(*data.reading.perturb)) {
    data.reading.perturb.reset();
  }
  data.reading.pose_frame = PoseFrame::kLidar;
  return fmt::format("use them with\n  mosbench run {}\n", to_words(data));
}

Answer odometry_answer(OdometryFlags flags) {
  std::optional<OdometryChoice> choice = flags.reading.refine_poses
                                             ? named_odometry(flags.odometry, flags.reading)
                                             : choose_odometry(flags.odometry, flags.reading);
  if (choice) flags.reading.poses = ByOdometry{};
  Dataset dataset = open_dataset(flags);
  if (choice) choice = with_filter(*std::move(choice), dataset.kind);
  if (choice) expect_poses(dataset, *choice);
  std::string text;
  nlohmann::ordered_json sequences = nlohmann::ordered_json::array();
  std::size_t doubtful = 0;
  for (const FoundPoses& found : write_poses(dataset, choice, flags.files)) {
    doubtful += doubtful_poses(found).size();
    text += found_text(found, choice ? choice->kind->title : "refining those given");
    sequences.push_back(found_json(found));
  }
  if (flags.files.out != "-") text += next_command(flags);
  nlohmann::ordered_json json = {{"refined", true}};
  if (choice) {
    json = {{"odometry", std::string(choice->kind->name)}, {"settings", to_json(choice->settings)}};
  }
  json["sequences"] = std::move(sequences);
  return answer_beside(flags.files.out, {.text = text,
                                         .exit_code = doubtful > 0 ? 1 : 0,
                                         .standing = standing_of(dataset),
                                         .json = json_text(json)});
}

}  // namespace

CommandRun add_odometry(CLI::App& command) {
  auto flags = std::make_shared<OdometryFlags>();
  add_scan_dataset_flags(command, *flags);
  const auto take = [flags](const std::string& text) { take_out(text, *flags); };
  add(command, "-o,--out FILE", take,
      "File of poses to write, TUM's if it ends in .tum or begins with tum:, else KITTI's; - is "
      "stdout; a folder for several sequences")
      ->required();
  add_odometry_flag(command, flags->odometry, "What finds the poses (default: simple)");
  command.add_flag("--overwrite", flags->files.overwrite, "Replace files of poses that are there");
  add_threads_flag(command, flags->files.threads);
  return [flags] { return odometry_answer(*flags); };
}

}  // namespace mosbench
