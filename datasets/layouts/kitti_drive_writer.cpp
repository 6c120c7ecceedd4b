#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/formats/tracklets.hpp"
#include "datasets/layouts/boxes.hpp"
#include "datasets/layouts/kitti_drive.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

fs::path raw_scan_file(std::size_t frame) {
  return fmt::format("velodyne_points/data/{:010}.bin", frame);
}
fs::path raw_oxts_file(std::size_t frame) { return fmt::format("oxts/data/{:010}.txt", frame); }
fs::path tracking_scan_file(std::size_t frame) {
  return fmt::format("training/velodyne/0000/{:06}.bin", frame);
}

/// A box; one that moves has fallen by the next frame, others are seen once.
struct WrittenBox {
  std::size_t frame;
  AxisBox box;
  bool moves;
  std::uint32_t instance;
};

constexpr std::uint32_t kInstanceAt = 16;

/// Points of a scan that one kind of box holds, by their labels.
using PointsOfLabel = std::map<std::uint32_t, std::vector<std::uint32_t>>;

/// Moving points by their instances, with the id 251, unlabelled ones under 0, all else under 9.
PointsOfLabel points_in_view(const Frame& frame, const CameraView& view) {
  PointsOfLabel points;
  for (std::uint32_t i = 0; i < frame.points.size(); ++i) {
    if (!view.sees(position_of(frame.points[i]))) continue;
    const std::uint32_t label = (*frame.truth)[i];
    const std::uint32_t instance = label >> kInstanceAt;
    const bool is_labelled = (label & 0xFFFFU) != 0;
    points[is_moving(label) ? (instance << kInstanceAt) + kMovingLabel
           : is_labelled    ? kStaticLabel
                            : 0U]
        .push_back(i);
  }
  return points;
}

/// Farther away a fallen box would not be where one is expected.
void expect_near(const AxisBox& box, const std::string& stem, const fs::path& folder) {
  constexpr double kFarthest_m = 1e5;
  if (box.low_m.cwiseAbs().maxCoeff() < kFarthest_m &&
      box.high_m.cwiseAbs().maxCoeff() < kFarthest_m) {
    return;
  }
  throw DataError(folder, "scan " + stem + " has a point to be in a box more than 100 km away",
                  "points where a LiDAR measures");
}

/// Returns the boxes of a scan with truth: each holds points of one label alone.
std::vector<WrittenBox> boxes_of(std::size_t scan_index, const Frame& frame, const CameraView& view,
                                 const fs::path& folder) {
  std::vector<WrittenBox> boxes;
  const PointsOfLabel points = points_in_view(frame, view);
  for (const auto& [label, inside] : points) {
    if (label == kStaticLabel) continue;
    std::vector<std::uint32_t> outside;
    for (const auto& [other, places] : points) {
      if (other != label) outside.insert(outside.end(), places.begin(), places.end());
    }
    for (const AxisBox& box : pure_boxes(frame.points, inside, std::move(outside))) {
      expect_near(box, frame.stem, folder);
      boxes.push_back({scan_index, box, label != 0, label >> kInstanceAt});
    }
  }
  return boxes;
}

/// All of a scan without truth, in a box that is seen once.
WrittenBox box_of_everything(std::size_t scan_index) {
  constexpr double kEverywhere_m = 1e4;
  return {scan_index,
          {Eigen::Vector3d::Constant(-kEverywhere_m), Eigen::Vector3d::Constant(kEverywhere_m)},
          false,
          0};
}

/// What both layouts write of a drive.
class DriveWriter : public SequenceWriter {
 public:
  DriveWriter(fs::path folder, const WriteOptions& options)
      : folder_(std::move(folder)),
        mounting_(written_kitti_mounting()),
        poses_(options.scans, Pose::Identity()),
        has_truth_(options.scans, 0),
        boxes_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    if (!frame.map_from_sensor.matrix().allFinite()) {
      throw DataError(folder_, "the pose of scan " + frame.stem + " is not finite", "numbers");
    }
    write_bin(folder_ / scan_file(scan_index), frame.points);
    poses_[scan_index] = frame.map_from_sensor;
    has_truth_[scan_index] = frame.truth ? 1 : 0;
    if (frame.truth) boxes_[scan_index] = boxes_of(scan_index, frame, mounting_.view, folder_);
  }

 protected:
  virtual fs::path scan_file(std::size_t frame) const = 0;

  const fs::path& folder() const { return folder_; }
  const KittiMounting& mounting() const { return mounting_; }

  /// One more than there are scans, for the last boxes to fall in.
  std::vector<OxtsPacket> packets() const {
    std::vector<Pose> map_from_imu;
    const Pose imu_from_lidar = mounting_.lidar_from_imu.inverse();
    for (const Pose& map_from_lidar : poses_) {
      map_from_imu.push_back(imu_from_lidar * map_from_lidar * mounting_.lidar_from_imu);
    }
    map_from_imu.push_back(map_from_imu.empty() ? Pose::Identity() : map_from_imu.back());
    std::vector<OxtsPacket> packets = oxts_of_poses(map_from_imu);
    const auto lost = std::ranges::find_if_not(packets, is_on_map);
    if (lost == packets.end()) return packets;
    const Eigen::Vector3d place_m =
        map_from_imu[static_cast<std::size_t>(lost - packets.begin())].translation();
    throw DataError(
        folder_,
        fmt::format("scan {} lies at {} {} {} m, which no packet of KITTI's GPS/IMU can say",
                    lost - packets.begin(), place_m.x(), place_m.y(), place_m.z()),
        "a drive within Mercator's projection");
  }

  bool has_truth() const { return std::ranges::find(has_truth_, 1) != has_truth_.end(); }

  std::vector<WrittenBox> written_boxes() const {
    std::vector<WrittenBox> written;
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      if (has_truth_[k] == 0) written.push_back(box_of_everything(k));
      written.insert(written.end(), boxes_[k].begin(), boxes_[k].end());
    }
    return written;
  }

 private:
  fs::path folder_;
  KittiMounting mounting_;
  std::vector<Pose> poses_;
  std::vector<std::uint8_t> has_truth_;  ///< of each scan
  std::vector<std::vector<WrittenBox>> boxes_;
};

class KittiRawWriter : public DriveWriter {
 public:
  KittiRawWriter(const fs::path& folder, const WriteOptions& options)
      : DriveWriter(folder, options), stamps_ns_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    constexpr std::int64_t kLast_ns = 9'214'646'400'000'000'000;  // the end of 2261
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    if (stamp_ns < 0 || stamp_ns >= kLast_ns) {
      throw DataError(folder(), "scan " + frame.stem + " has a stamp that is no date of KITTI's",
                      "one of 1970 to 2261");
    }
    stamps_ns_[scan_index] = stamp_ns;
    DriveWriter::write(scan_index, frame);
  }

  void finish() override {
    expect_rising_stamps();
    const std::vector<OxtsPacket> rows = packets();
    const KittiCalibTexts texts = format_kitti_mounting(mounting());
    const fs::path date = folder().parent_path();
    write_file_atomic(date / "calib_imu_to_velo.txt", texts.imu_to_velo);
    write_file_atomic(date / "calib_velo_to_cam.txt", texts.velo_to_cam);
    write_file_atomic(date / "calib_cam_to_cam.txt", texts.cam_to_cam);
    if (has_truth()) write_file_atomic(folder() / "tracklet_labels.xml", tracklets());
    write_file_atomic(folder() / "velodyne_points/timestamps.txt", format_kitti_stamps(stamps_ns_));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      write_file_atomic(folder() / raw_oxts_file(k), format_oxts({&rows[k], 1}));
    }
    constexpr std::int64_t kPeriod_ns = 100'000'000;
    stamps_ns_.push_back(stamps_ns_.empty() ? 0 : *stamps_ns_.back() + kPeriod_ns);
    sync_file_system_of(folder());
    commit_file(folder() / kKittiRawLastFile, format_kitti_stamps(stamps_ns_));
  }

 private:
  fs::path scan_file(std::size_t frame) const override { return raw_scan_file(frame); }

  void expect_rising_stamps() const {
    const auto twin = std::ranges::adjacent_find(stamps_ns_, std::greater_equal<>());
    if (twin == stamps_ns_.end()) return;
    throw DataError(
        folder(),
        fmt::format("scan {} is not later than the one before", twin - stamps_ns_.begin() + 1),
        "stamps that increase, by which boxes have their speed");
  }

  std::string tracklets() const {
    std::vector<Tracklet> tracklets;
    for (const WrittenBox& written : written_boxes()) {
      const Eigen::Vector3d size_m = written.box.high_m - written.box.low_m;
      Eigen::Vector3d bottom_m = 0.5 * (written.box.low_m + written.box.high_m);
      bottom_m.z() -= 0.5 * size_m.z();
      Tracklet& tracklet = tracklets.emplace_back();
      tracklet = {type_of_part(written.instance),
                  size_m.z(),
                  size_m.y(),
                  size_m.x(),
                  written.frame,
                  {{bottom_m, 0.0}}};
      if (!written.moves) continue;
      bottom_m.z() -= kFall_m;
      tracklet.poses.push_back({bottom_m, 0.0});
    }
    return format_tracklets(tracklets);
  }

  std::vector<std::optional<std::int64_t>> stamps_ns_;
};

class KittiTrackingWriter : public DriveWriter {
 public:
  using DriveWriter::DriveWriter;

  void finish() override {
    const std::string rows = format_oxts(packets());
    write_file_atomic(folder() / "training/calib/0000.txt", format_tracking_calib(mounting()));
    if (has_truth()) {
      write_file_atomic(folder() / "training/label_02/0000.txt", format_tracking_labels(labels()));
    }
    sync_file_system_of(folder());
    commit_file(folder() / kKittiTrackingLastFile, rows);
  }

 private:
  fs::path scan_file(std::size_t frame) const override { return tracking_scan_file(frame); }

  std::vector<TrackingLabel> labels() const {
    std::vector<TrackingLabel> labels;
    const Pose& camera_from_lidar = mounting().view.rectified_from_lidar;
    std::int64_t track = 0;
    for (const WrittenBox& written : written_boxes()) {
      const Eigen::Vector3d size_m = written.box.high_m - written.box.low_m;
      CameraBox box = {size_m.z(), size_m.y(), size_m.x(), Eigen::Vector3d::Zero(),
                       -0.5 * std::numbers::pi};
      box.bottom_m = camera_from_lidar * (0.5 * (written.box.low_m + written.box.high_m));
      box.bottom_m.y() += 0.5 * size_m.z();
      const std::string type = type_of_part(written.instance);
      labels.push_back({written.frame, track, type, {}, box});
      if (written.moves) {
        box.bottom_m.y() += kFall_m;
        labels.push_back({written.frame + 1, track, type, {}, box});
      }
      ++track;
    }
    return labels;
  }
};

}  // namespace

std::vector<fs::path> files_of_kitti_raw(const Sequence& sequence) {
  std::vector<fs::path> files = {"tracklet_labels.xml", "velodyne_points/timestamps.txt",
                                 "../calib_imu_to_velo.txt", "../calib_velo_to_cam.txt",
                                 "../calib_cam_to_cam.txt"};
  for (std::size_t k = 0; k <= sequence.size(); ++k) files.push_back(raw_oxts_file(k));
  for (std::size_t k = 0; k < sequence.size(); ++k) files.push_back(raw_scan_file(k));
  return files;
}

std::vector<fs::path> files_of_kitti_tracking(const Sequence& sequence) {
  std::vector<fs::path> files = {"training/calib/0000.txt", "training/label_02/0000.txt"};
  for (std::size_t k = 0; k < sequence.size(); ++k) files.push_back(tracking_scan_file(k));
  return files;
}

std::unique_ptr<SequenceWriter> write_as_kitti_raw(const fs::path& folder,
                                                   const WriteOptions& options) {
  return std::make_unique<KittiRawWriter>(folder, options);
}

std::unique_ptr<SequenceWriter> write_as_kitti_tracking(const fs::path& folder,
                                                        const WriteOptions& options) {
  return std::make_unique<KittiTrackingWriter>(folder, options);
}

}  // namespace mosbench
