#include "eval/engine/pose_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/output.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// What two records must share for their poses to be the same.
nlohmann::ordered_json record_identity(const Sequence& sequence,
                                       const std::optional<OdometryChoice>& choice) {
  ReadingDone reading = sequence.reading();
  if (choice) reading.poses = statement_of(*choice);
  if (choice && choice->says_deskew) reading.deskew = choice->deskew;
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

/// KITTI's rows belong to all scans, the first to the first.
void refuse_part(const Sequence& sequence) {
  if (sequence.reading().scans.empty()) return;
  throw UsageError(fmt::format(
      "{}: KITTI's rows belong to all scans of {}, expected TUM's, which have stamps (a file "
      "called *.tum, or tum:FILE), or all scans",
      option("scans"), sequence.name()));
}

FoundPoses find_poses_of(const Sequence& sequence, const std::filesystem::path& file,
                         const std::optional<OdometryChoice>& choice, const PoseFiles& files) {
  FoundPoses found{sequence, file,
                   choice ? scans_json(sequence, estimate_poses(sequence, *choice, files.threads))
                          : scans_json(sequence)};
  write_pose_file(file, pose_rows(found, files.as_tum), files.as_tum);
  return found;
}

/// One of several sequences: with a record beside its poses, so that a call after a kill goes on
/// with the first sequence that is not finished.
FoundPoses find_or_keep(const Sequence& sequence, const std::optional<OdometryChoice>& choice,
                        const PoseFiles& files) {
  const std::filesystem::path stem = files.out / sequence.name();
  const std::filesystem::path file = stem.string() + (files.as_tum ? ".tum" : ".txt");
  const std::filesystem::path record = stem.string() + ".json";
  const nlohmann::ordered_json identity = record_identity(sequence, choice);
  if (auto scans = recorded_scans(record, identity, {sequence, file, {}}, files.as_tum)) {
    tell(fmt::format("{}: finished by an earlier call, kept", sequence.name()));
    return {sequence, file, std::move(*scans)};
  }
  FoundPoses found = find_poses_of(sequence, file, choice, files);
  commit_file(record, json_text({{"identity", identity}, {"scans", found.scans}}));
  return found;
}

}  // namespace

std::vector<FoundPoses> write_poses(const Dataset& dataset,
                                    const std::optional<OdometryChoice>& choice,
                                    const PoseFiles& files) {
  for (const auto& sequence : dataset.sequences) {
    files.as_tum ? check_stamps_of_tum(*sequence) : refuse_part(*sequence);
  }
  const bool single = dataset.sequences.size() == 1;
  if (files.out == "-" && !single) {
    throw UsageError("-o -: has no room for several sequences, expected a folder");
  }
  if (single) check_output(files.out);
  const std::optional<FolderLock> lock =
      single ? std::nullopt : std::make_optional<FolderLock>(files.out);
  std::vector<FoundPoses> found;
  for (const auto& sequence : dataset.sequences) {
    found.push_back(single ? find_poses_of(*sequence, files.out, choice, files)
                           : find_or_keep(*sequence, choice, files));
  }
  return found;
}

}  // namespace mosbench
