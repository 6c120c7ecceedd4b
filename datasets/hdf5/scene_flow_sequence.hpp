#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// The scans of an .h5 file of OpenSceneFlow, a group each, by stamp. A scan is labelled when it
/// has a flow to the next one, from which truth is computed by speed; or `mos_label`.
class SceneFlowSequence : public Sequence {
 public:
  /// Throws DataError.
  SceneFlowSequence(std::string name, const std::filesystem::path& file, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  /// A group, in the order of stamps.
  struct Scan {
    const Hdf5Group* group = nullptr;
    std::int64_t stamp_ns = 0;
    std::size_t points = 0;
    std::optional<Pose> map_from_sensor;  ///< the file's own
  };

  void list_scans();
  void convert_stamps();
  void require_poses(bool of_all) const;
  void take_poses(const Reading& asked);
  void state_truth(const Reading& asked);
  Scan scan_of(const Hdf5Group& group, std::uint64_t stamp) const;
  Pose pose_in(const Hdf5Group& group, std::string_view name) const;
  std::size_t check_points(const Hdf5Group& group) const;
  bool has_flow(std::size_t scan) const;
  bool has_labels(std::size_t scan) const;
  void refuse_coarse_pose(const Scan& scan, double time_s) const;
  SensorStep step_after(std::size_t scan) const;
  std::vector<Point> points_of(const Scan& scan, std::vector<Point> reused) const;
  std::vector<std::int64_t> values(const Scan& scan, std::string_view name) const;
  template <typename Value>
  std::vector<Value> values_as(const Scan& scan, std::string_view name) const;
  std::vector<std::uint8_t> flags(const Scan& scan, std::string_view name) const;
  PointMotions motions_of(std::size_t scan, std::span<const Point> points) const;
  std::vector<std::uint32_t> labels_of(std::size_t scan, const PointMotions& motions) const;
  std::vector<std::uint32_t> stored_labels(const Scan& scan) const;

  Hdf5File file_;
  double moving_speed_m_s_;
  std::vector<Scan> scans_;          ///< all of the file
  std::vector<std::size_t> places_;  ///< of the recording's scans in scans_
};

/// Returns the names of the scans of a file that have eval_mask, sorted as text: those that
/// Argoverse 2's benchmark evaluates.
std::vector<std::string> evaluated_scans(const std::filesystem::path& file);

}  // namespace mosbench
