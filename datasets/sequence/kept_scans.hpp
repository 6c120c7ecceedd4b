#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <span>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Copies of scans that were read, as many as there is room for, so that they need not be read
/// again. Safe to use from several threads.
class KeptScans {
 public:
  explicit KeptScans(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Copies a scan to `frame`, whose memory is reused. Returns false when it is not kept.
  bool find(std::size_t scan_index, Frame& frame) const;
  /// Keeps a scan if there is room for it.
  void keep(std::size_t scan_index, const Frame& frame);
  /// Forgets all scans.
  void clear();
  /// Of all scans that are kept.
  std::size_t bytes() const;

 private:
  struct Scan {
    Frame small;  ///< without what follows
    std::span<const Point> points;
    std::span<const std::int64_t> point_times_ns;
    std::optional<std::span<const std::uint32_t>> truth;
  };
  template <typename Value>
  std::span<const Value> copy(const std::vector<Value>& values);

  // Chunks that do not come from the heap, which lasting copies between buffers that come and go
  // would split.
  static constexpr std::size_t kFirstChunkBytes = std::size_t{64} << 20;

  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::pmr::monotonic_buffer_resource memory_{kFirstChunkBytes};
  std::map<std::size_t, Scan> scans_;
  std::size_t bytes_ = 0;
};

/// A sequence whose scans are looked for in `scans` before they are read. Several sequences may
/// share them if they read the same files in the same way.
class KeptSequence : public SequenceAround {
 public:
  KeptSequence(std::unique_ptr<Sequence> inner, std::shared_ptr<KeptScans> scans);

  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::size_t kept_bytes() const override { return scans_->bytes(); }

 private:
  std::shared_ptr<KeptScans> scans_;
};

}  // namespace mosbench
