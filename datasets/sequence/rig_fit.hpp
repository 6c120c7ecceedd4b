#pragma once

#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns a sentence for each LiDAR of a rig that sees the same places as the first one, but not
/// under its mount and the poses; nothing for those that share too little to tell. Throws
/// DataError.
std::vector<std::string> doubts_about_mounts(const Sequence& rig);

/// Adds them to its doubts. Leaves scans that cannot be read to those who need them.
void doubt_mounts(Sequence& rig);

}  // namespace mosbench
