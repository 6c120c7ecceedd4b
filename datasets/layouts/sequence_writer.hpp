#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Writes the frames of one sequence in some layout.
class SequenceWriter {
 public:
  virtual ~SequenceWriter() = default;
  /// Writes one scan; every index is written once. Files of single scans may be written in any
  /// order and by several threads, messages of a bag only in order.
  virtual void write(std::size_t scan_index, const Frame& frame) = 0;
  /// Writes what has to wait for the last frame, poses last; before, the folder cannot be opened.
  virtual void finish() = 0;
};

struct WriteOptions {
  std::size_t scans = 0;
  /// Tr of calib.txt in layouts that have it: the poses of the frames are those of the camera.
  Pose camera_from_lidar = Pose::Identity();
  bool as_bag = false;              ///< of DOALS: a bag instead of files
  std::string compression = "lz4";  ///< of the bag's chunks: none, lz4, bz2
};

/// Returns the name of the file that appears when all of a sequence is on the disk.
const char* last_file_of(const WriteOptions& options);

/// Writes velodyne/, labels/ for frames with truth, times.txt when all frames have stamps,
/// calib.txt and poses.txt.
std::unique_ptr<SequenceWriter> write_as_kitti(const std::filesystem::path& folder,
                                               const WriteOptions& options);

/// Writes velodyne/, times.txt and poses.txt, or bag.bag with /os1_cloud_node/points and /tf from
/// map to os1_lidar; and indices.csv with the points of an id of 251 to 259. Frames without stamps
/// get ones 0.1 s apart. Throws as BagWriter.
std::unique_ptr<SequenceWriter> write_as_doals(const std::filesystem::path& folder,
                                               const WriteOptions& options);

}  // namespace mosbench
