#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/layouts/sequence_writer.hpp"

namespace mosbench {

/// The file of the poses, which is written last.
inline constexpr const char* kNuscenesLastFile = "v1.0-mini/ego_pose.json";

/// Returns the files that `write_as_nuscenes` may write of a sequence.
std::vector<std::filesystem::path> files_of_nuscenes(const Sequence& sequence);

/// Writes one scene, called as the folder, with tables of its own in v1.0-mini/: those that
/// `read_nuscenes_tables` reads. Scans with truth are key frames. Each moving point is an
/// annotation of 0.02 mm, so that the truth is read back as it is; points of other ids are static
/// then. Stamps are rounded down to microseconds.
std::unique_ptr<SequenceWriter> write_as_nuscenes(const std::filesystem::path& folder,
                                                  const WriteOptions& options);

}  // namespace mosbench
