#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "datasets/layouts/nuscenes_tables.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One scene of nuScenes: every scan of LIDAR_TOP, key frames and sweeps, with poses of ego_pose
/// and calibrated_sensor. Key frames have truth where the tables have annotations: 251 in boxes of
/// what moves, 9 elsewhere.
class NuscenesSequence : public Sequence {
 public:
  /// Throws DataError for tables that do not fit each other and for missing scans, UsageError for
  /// options that say how other files are read.
  NuscenesSequence(std::string name, const std::filesystem::path& tables, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  void list_scans(const std::filesystem::path& root, const NuscenesScene& scene);
  void take_poses(const std::filesystem::path& folder, const Reading& asked);
  void say_what_is_read(const std::filesystem::path& folder);

  std::shared_ptr<const NuscenesTables> tables_;
  std::vector<const NuscenesScan*> scans_;  ///< in `tables_`
};

}  // namespace mosbench
