#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "datasets/layouts/sequence_writer.hpp"

namespace mosbench {

/// Returns the file of the poses, which is written last.
const char* helipr_last_file(const WriteOptions& options);

/// Returns the files that `write_as_helipr` may write of a sequence.
std::vector<std::filesystem::path> files_of_helipr(const Sequence& sequence);

/// Writes the scans as those of HeLiPR's Aeva where they have radial velocities, else of its
/// Ouster: neither loses a bit of a point. Without truth, for which HeLiPR has no place. Scans
/// without stamps get ones 0.1 s apart.
std::unique_ptr<SequenceWriter> write_as_helipr(const std::filesystem::path& folder,
                                                const WriteOptions& options);

}  // namespace mosbench
