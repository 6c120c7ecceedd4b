#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

struct OdometryFlags : DataWords {
  std::filesystem::path out;
  OdometryOptions odometry;
  bool as_tum = false;
  unsigned threads = hardware_threads();
};

/// FILE, or kitti:FILE or tum:FILE where its name does not say.
void take_out(const std::string& text, OdometryFlags& flags) {
  constexpr std::string_view kKitti = "kitti:", kTum = "tum:";
  const bool says_tum = text.starts_with(kTum), says_kitti = text.starts_with(kKitti);
  flags.out = text.substr(says_tum ? kTum.size() : says_kitti ? kKitti.size() : 0);
  flags.as_tum = says_tum || (!says_kitti && flags.out.extension() == ".tum");
}

/// What two records must share for their poses to be the same.
nlohmann::ordered_json record_identity(const Sequence& sequence, const OdometryChoice& choice) {
  ReadingDone reading = sequence.reading();
  reading.poses = statement_of(choice);
  if (choice.says_deskew) reading.deskew = choice.deskew;
  return {{"sequence", sequence.name()},
          {"reading", to_json(members_of(reading))},
          {"file_stamp", file_stamp(sequence)},
          {"code", code_json()}};
}

/// The scans of a record that an earlier call left when it had written the pose file, if the same
/// question was asked and the file still holds these poses.
std::optional<nlohmann::ordered_json> recorded_scans(const std::filesystem::path& record,
                                                     const nlohmann::ordered_json& identity,
                                                     const FoundPoses& none, bool as_tum) {
  if (!is_there(record) || !is_there(none.file)) return std::nullopt;
  try {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(read_file(record));
    if (json.at("identity") != identity) return std::nullopt;
    FoundPoses found{none.sequence, none.file, std::move(json.at("scans"))};
    const bool whole = found.scans.size() == found.sequence.size();
    (void)found_text(found, "");  // throws where something is missing
    if (!whole || pose_rows(found, as_tum) != read_file(found.file)) return std::nullopt;
    return std::move(found.scans);
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // not what this program wrote
  }
}

/// Whether a file of this name lies beside others: stdout and pipes do not.
bool lies_in_a_folder(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const std::string place = std::filesystem::absolute(file).lexically_normal().string();
  return file != "-" && !place.starts_with("/dev/") && !place.starts_with("/proc/") &&
         (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status));
}

/// KITTI's rows do not say that they are the lidar's, which a calib.txt would take for the
/// camera's.
void write_pose_file(const std::filesystem::path& file, const std::string& rows, bool as_tum) {
  if (!as_tum && lies_in_a_folder(file)) mark_as_lidars(file, rows);
  write_output(file, rows);
}

FoundPoses find_poses_of(const Sequence& sequence, const std::filesystem::path& file,
                         const OdometryChoice& choice, const OdometryFlags& flags) {
  FoundPoses found{sequence, file,
                   scans_json(sequence, estimate_poses(sequence, choice, flags.threads))};
  write_pose_file(file, pose_rows(found, flags.as_tum), flags.as_tum);
  return found;
}

/// One of several sequences: with a record beside its poses, so that a call after a kill goes on
/// with the first sequence that is not finished.
FoundPoses find_or_keep(const Sequence& sequence, const OdometryChoice& choice,
                        const OdometryFlags& flags) {
  const std::filesystem::path stem = flags.out / sequence.name();
  const std::filesystem::path file = stem.string() + (flags.as_tum ? ".tum" : ".txt");
  const std::filesystem::path record = stem.string() + ".json";
  const nlohmann::ordered_json identity = record_identity(sequence, choice);
  if (auto scans = recorded_scans(record, identity, {sequence, file, {}}, flags.as_tum)) {
    tell(fmt::format("{}: finished by an earlier call, kept", sequence.name()));
    return {sequence, file, std::move(*scans)};
  }
  FoundPoses found = find_poses_of(sequence, file, choice, flags);
  commit_file(record, json_text({{"identity", identity}, {"scans", found.scans}}));
  return found;
}

/// The command that uses the poses: of the sensor itself, also where the layout's own are a
/// camera's.
std::string next_command(const OdometryFlags& flags) {
  Data data = data_of(flags);
  data.reading.poses = PoseFile{flags.out};
  data.reading.pose_frame = PoseFrame::kLidar;
  return fmt::format("use them with\n  mosbench run {}\n", to_words(data));
}

Answer odometry_answer(OdometryFlags flags) {
  OdometryChoice choice = choose_odometry(flags.odometry, flags.reading);
  flags.reading.poses = ByOdometry{};
  const Dataset dataset = open_dataset(flags);
  choice = with_filter(std::move(choice), dataset.kind);
  for (const auto& sequence : dataset.sequences) {
    if (flags.as_tum) check_stamps_of_tum(*sequence);
  }
  const bool single = dataset.sequences.size() == 1;
  if (flags.out == "-" && !single) {
    throw UsageError("-o -: has no room for several sequences, expected a folder");
  }
  if (single) check_output(flags.out);
  const std::optional<FolderLock> lock =
      single ? std::nullopt : std::make_optional<FolderLock>(flags.out);
  std::string text;
  nlohmann::ordered_json sequences = nlohmann::ordered_json::array();
  std::size_t doubtful = 0;
  for (const auto& sequence : dataset.sequences) {
    const FoundPoses found = single ? find_poses_of(*sequence, flags.out, choice, flags)
                                    : find_or_keep(*sequence, choice, flags);
    doubtful += doubtful_scans(found);
    text += found_text(found, choice.kind->title);
    sequences.push_back(found_json(found));
  }
  if (flags.out != "-") text += next_command(flags);
  return answer_beside(flags.out, {.text = text,
                                   .exit_code = doubtful > 0 ? 1 : 0,
                                   .standing = standing_of(dataset),
                                   .json = json_text({{"odometry", std::string(choice.kind->name)},
                                                      {"settings", to_json(choice.settings)},
                                                      {"sequences", sequences}})});
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
  add_threads_flag(command, flags->threads);
  return [flags] { return odometry_answer(*flags); };
}

}  // namespace mosbench
