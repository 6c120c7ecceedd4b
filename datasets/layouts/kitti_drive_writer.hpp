#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/layouts/simulation.hpp"

namespace mosbench {

/// The files that are written last, from the folder of a sequence.
inline constexpr const char* kKittiRawLastFile = "oxts/timestamps.txt";
inline constexpr const char* kKittiTrackingLastFile = "training/oxts/0000.txt";

/// Returns the files that the writers may write of a sequence.
std::vector<std::filesystem::path> files_of_kitti_raw(const Sequence& sequence);
std::vector<std::filesystem::path> files_of_kitti_tracking(const Sequence& sequence);

/// Returns the label of a simulated point: 9, 251 with the owner as instance or, without a label
/// and all beyond the camera's view, 0.
std::uint32_t kitti_label_in_view(const SimulatedReturn& seen);

/// Writes a drive of KITTI's raw data, the calibration beside its folder. Scans are called by their
/// numbers; frames without stamps get ones 0.1 s apart. Points in the view of camera 2 keep whether
/// they are labelled and whether they move, and moving ones their instance: these lie in boxes that
/// are 1000 km lower in the next frame and whose type says the instance, unlabelled ones, as all of
/// a scan without truth, in boxes that are seen once; where no scan has truth no tracklets are
/// written. oxts go on for one frame after the last. Throws DataError for stamps that do not
/// increase or are not within 1970 to 2261, and for poses and moving points that are farther away
/// than the files can say.
std::unique_ptr<SequenceWriter> write_as_kitti_raw(const std::filesystem::path& folder,
                                                   const WriteOptions& options);

/// The same as sequence 0000 of the tracking benchmark, which has no stamps.
std::unique_ptr<SequenceWriter> write_as_kitti_tracking(const std::filesystem::path& folder,
                                                        const WriteOptions& options);

}  // namespace mosbench
