#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/sequence/scan_source.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A sequence whose scans, poses and stamps are those of a ScanSource; a layout adds the truth.
class SourcedSequence : public Sequence {
 public:
  std::string name() const override { return name_; }
  std::size_t size() const override { return scans_->size(); }
  std::string stem(std::size_t scan_index) const override { return scans_->stem(scan_index); }
  std::optional<std::filesystem::path> scan_file(std::size_t scan_index) const override {
    return scans_->own_file(scan_index);
  }
  Pose map_from_sensor(std::size_t scan_index) const override {
    return scans_->map_from_sensor(scan_index);
  }
  std::optional<std::int64_t> stamp_ns(std::size_t scan_index) const override {
    return scans_->stamp_ns(scan_index);
  }
  std::size_t point_count(std::size_t scan_index) const override {
    return scans_->point_count(scan_index);
  }
  ReadingStatement reading() const override { return scans_->reading(); }

 protected:
  SourcedSequence(std::string name, std::unique_ptr<ScanSource> scans)
      : name_(std::move(name)), scans_(std::move(scans)) {}
  const ScanSource& source() const { return *scans_; }

 private:
  Frame read_frame(std::size_t scan_index, Frame spent) const override {
    Frame frame = scans_->read(scan_index, std::move(spent));
    if (has_truth(scan_index)) frame.truth = read_truth(scan_index);
    return frame;
  }

  std::string name_;
  std::unique_ptr<ScanSource> scans_;
};

}  // namespace mosbench
