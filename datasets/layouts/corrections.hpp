#pragma once

#include <memory>
#include <optional>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Throws UsageError where LiDARs are named that cannot be read by name, or not so.
void check_lidars(const Reading& asked, bool is_recording);

/// Returns how points are to be moved; nothing unless they have times.
std::optional<Deskew> deskew_of(const Sequence& sequence, const Reading& reading);

/// Whether the poses that deskew are yet to be refined. Disturbed ones, which are, do not deskew,
/// nor do those of a rig, whose scans are to fit together before.
bool deskews_by_refined_poses(const Reading& reading);

/// Returns the sequence without what is to be left out, and with the points moved that are to be.
std::unique_ptr<Sequence> corrected(std::unique_ptr<Sequence> sequence, const Reading& reading);

}  // namespace mosbench
