#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Tells of a sequence how many of its scans are done.
using ScanCount =
    std::function<void(const std::string& sequence, std::size_t done, std::size_t scans)>;

/// Returns the sequence, opened without poses, of a sensor that stands still, and says how that is
/// known. Poses that are there and move by `passed_over_m` are doubted; 0 where there are none.
std::unique_ptr<Sequence> with_static_poses(std::unique_ptr<Sequence> inner,
                                            const std::string& remark, double passed_over_m = 0.0);

/// Returns the sequence with its poses corrected by `PoseRefiner`, and a remark on how far. Scans
/// whose points have times are deskewed by the corrected poses. The same sequence is registered
/// once in a process. Throws DataError.
std::unique_ptr<Sequence> with_refined_poses(std::unique_ptr<Sequence> inner,
                                             std::optional<Deskew> deskew, const ScanCount& count);

}  // namespace mosbench
