#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/files/folder_listing.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One sequence of KTH's DynamicMap_Benchmark: pcd/*.pcd with points in the map's frame, the
/// sensor's pose in VIEWPOINT, and in intensity 1 for what is dynamic. Points are given in the
/// sensor's frame and without intensity, which is the truth and not for a method to see.
class KthSequence : public Sequence {
 public:
  /// Throws DataError when a scan has no VIEWPOINT.
  KthSequence(std::string name, const std::filesystem::path& folder);

  std::string name() const override { return name_; }
  std::size_t size() const override { return scans_.size(); }
  std::string stem(std::size_t scan_index) const override { return scans_.at(scan_index).stem; }
  bool has_truth(std::size_t) const override { return true; }
  std::optional<std::filesystem::path> scan_file(std::size_t scan_index) const override {
    return scans_.at(scan_index).file;
  }
  Pose map_from_sensor(std::size_t scan_index) const override { return poses_.at(scan_index); }
  std::optional<std::int64_t> stamp_ns(std::size_t) const override { return std::nullopt; }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;
  std::size_t point_count(std::size_t scan_index) const override {
    return point_counts_.at(scan_index);
  }
  std::vector<std::filesystem::path> files() const override;
  std::vector<std::string> remarks() const override;
  ReadingStatement reading() const override;

 private:
  Frame read_frame(std::size_t scan_index, Frame spent) const override;
  std::string name_;
  std::vector<StemFile> scans_;
  std::vector<std::size_t> point_counts_;
  std::vector<Pose> poses_;
};

}  // namespace mosbench
