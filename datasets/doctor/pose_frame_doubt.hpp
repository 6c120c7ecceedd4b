#pragma once

#include <optional>
#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A sentence for poses that were turned from the camera to the lidar by the Tr in calib.txt, where
/// scans overlap clearly better under the rows as they stand in the file: nobody said that they are
/// the camera's, and they seem to be the lidar's. Reads some scans, at most 10. Throws DataError.
std::optional<std::string> doubt_about_pose_frame(const Sequence& sequence);

}  // namespace mosbench
