#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Takes the frames of one sequence in order and leaves it on disk in some layout.
class SequenceWriter {
 public:
  virtual ~SequenceWriter() = default;
  virtual void add(const Frame& frame) = 0;
  /// Writes what has to wait for the last frame; before, the folder cannot be opened.
  virtual void finish() = 0;
};

/// velodyne/, labels/ for frames with truth, times.txt for frames with stamps, calib.txt with the
/// identity, and the lidar's poses.
std::unique_ptr<SequenceWriter> write_as_kitti(const std::filesystem::path& folder);

/// velodyne/, times.txt, poses.txt, and indices.csv with the points of an id of 251 to 259. Frames
/// without stamps get ones 0.1 s apart.
std::unique_ptr<SequenceWriter> write_as_doals(const std::filesystem::path& folder);

/// bag.bag with /os1_cloud_node/points and /tf from map to os1_lidar, and indices.csv. Throws as
/// BagWriter.
std::unique_ptr<SequenceWriter> write_as_doals_bag(const std::filesystem::path& folder,
                                                   const std::string& compression);

}  // namespace mosbench
