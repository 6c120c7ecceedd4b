#include "datasets/layouts/helipr_writer.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "datasets/files/disk_sync.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/helipr_points.hpp"

namespace mosbench {
namespace {

class HeliprWriter : public SequenceWriter {
 public:
  HeliprWriter(std::filesystem::path folder, const WriteOptions& options)
      : folder_(std::move(folder)), poses_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    if (stamp_ns < 0) {
      throw DataError(folder_, "scan " + frame.stem + " has a stamp below 0", "ns since 1970");
    }
    poses_[scan_index] = {stamp_ns, frame.map_from_sensor};
    write_file_atomic(folder_ / helipr_scan_file(stamp_ns), format_helipr_ouster(frame.points));
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
    commit_file(folder_ / kHeliprLastFile, format_helipr_poses(poses_));
  }

 private:
  std::filesystem::path folder_;
  std::vector<HeliprPose> poses_;
};

}  // namespace

std::filesystem::path helipr_scan_file(std::int64_t stamp_ns) {
  return std::filesystem::path("LiDAR/Ouster") / fmt::format("{}.bin", stamp_ns);
}

std::unique_ptr<SequenceWriter> write_as_helipr(const std::filesystem::path& folder,
                                                const WriteOptions& options) {
  return std::make_unique<HeliprWriter>(folder, options);
}

}  // namespace mosbench
