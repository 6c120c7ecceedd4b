#include "datasets/layouts/helipr_writer.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/helipr_points.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

HeliprSensor sensor_of(bool radial_velocities) {
  return radial_velocities ? HeliprSensor::kAeva : HeliprSensor::kOuster;
}

std::filesystem::path scan_file(HeliprSensor sensor, std::int64_t stamp_ns) {
  return std::filesystem::path("LiDAR") / to_string(sensor) / fmt::format("{}.bin", stamp_ns);
}

class HeliprWriter : public SequenceWriter {
 public:
  HeliprWriter(std::filesystem::path folder, const WriteOptions& options)
      : folder_(std::move(folder)),
        sensor_(sensor_of(options.radial_velocities)),
        last_file_(helipr_last_file(options)),
        poses_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    if (stamp_ns < 0) {
      throw DataError(folder_, "scan " + frame.stem + " has a stamp below 0", "ns since 1970");
    }
    poses_[scan_index] = {stamp_ns, frame.map_from_sensor};
    write_file_atomic(folder_ / scan_file(sensor_, stamp_ns), packed(frame, stamp_ns));
  }

  void finish() override {
    for (std::size_t k = 1; k < poses_.size(); ++k) {
      if (poses_[k].stamp_ns > poses_[k - 1].stamp_ns) continue;
      throw DataError(folder_,
                      fmt::format("two scans or more up to {} have stamps that do not "
                                  "increase",
                                  poses_[k].stamp_ns),
                      "one after the other, as HeLiPR names scans by them");
    }
    sync_file_system_of(folder_);
    commit_file(folder_ / last_file_, format_helipr_poses(poses_));
  }

 private:
  std::string packed(const Frame& frame, std::int64_t stamp_ns) const {
    if (sensor_ != HeliprSensor::kAeva) return format_helipr_ouster(frame.points);
    if (frame.radial_velocity_m_s.size() != frame.points.size()) {
      throw DataError(folder_,
                      fmt::format("scan {} has {} radial velocities", frame.stem,
                                  frame.radial_velocity_m_s.size()),
                      fmt::format("one for each of its {} points", frame.points.size()));
    }
    return format_helipr_aeva(frame.points, frame.radial_velocity_m_s, stamp_ns);
  }

  std::filesystem::path folder_;
  HeliprSensor sensor_;
  const char* last_file_;
  std::vector<HeliprPose> poses_;
};

}  // namespace

const char* helipr_last_file(const WriteOptions& options) {
  return options.radial_velocities ? "LiDAR_GT/Aeva_gt.txt" : "LiDAR_GT/Ouster_gt.txt";
}

std::vector<std::filesystem::path> files_of_helipr(const Sequence& sequence) {
  const HeliprSensor sensor = sensor_of(sequence.recording().has_radial_velocities);
  std::vector<std::filesystem::path> files;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    files.push_back(scan_file(sensor, stamp_or_period_ns(k, sequence.stamp_ns(k))));
  }
  return files;
}

std::unique_ptr<SequenceWriter> write_as_helipr(const std::filesystem::path& folder,
                                                const WriteOptions& options) {
  return std::make_unique<HeliprWriter>(folder, options);
}

}  // namespace mosbench
