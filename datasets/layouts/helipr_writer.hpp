#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "datasets/layouts/sequence_writer.hpp"

namespace mosbench {

/// The file of the poses, which is written last.
inline constexpr const char* kHeliprLastFile = "LiDAR_GT/Ouster_gt.txt";

/// Returns the place of a scan with this stamp.
std::filesystem::path helipr_scan_file(std::int64_t stamp_ns);

/// Writes the scans as those of HeLiPR's Ouster, which loses no bit of a point; without truth, for
/// which HeLiPR has no place. Scans without stamps get ones 0.1 s apart.
std::unique_ptr<SequenceWriter> write_as_helipr(const std::filesystem::path& folder,
                                                const WriteOptions& options);

}  // namespace mosbench
