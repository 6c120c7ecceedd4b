#pragma once

#include <mosbench/method.hpp>
#include <mosbench/scan.hpp>
#include <optional>
#include <stdexcept>

namespace mosbench {

/// A scan that remembers which method observed it, and when.
struct NumberedScan : Observed {
  const void* observer = nullptr;
  std::size_t number = 0;
};

/// Keeps what Method::push promises: own scans alone, in the order in which they were observed, no
/// more than announced, none after the end.
class PushOrder {
 public:
  explicit PushOrder(std::optional<std::size_t> scan_count) : scan_count_(scan_count) {}
  PushOrder(const PushOrder&) = delete;
  PushOrder& operator=(const PushOrder&) = delete;

  /// Numbers a scan. May run while another thread pushes the scan before.
  void number(NumberedScan& scan) {
    scan.observer = this;
    scan.number = ++observed_;
  }

  /// Throws std::logic_error when no further scan may be pushed.
  void expect_scan() const {
    if (finished_) throw std::logic_error("pushed a scan after finish");
    if (scan_count_ && pushed_ >= *scan_count_) {
      throw std::logic_error("pushed more scans than scan_count announced");
    }
  }

  /// Returns the scan as what it was observed as, and counts it. Throws std::logic_error as
  /// expect_scan, for a scan of another observer, and for one observed before the last one pushed.
  template <typename Scan>
  Scan& take(Observed* observed) {
    expect_scan();
    auto* scan = dynamic_cast<Scan*>(observed);
    if (scan == nullptr || scan->observer != this) {
      throw std::logic_error("pushed a scan that this method did not observe");
    }
    if (scan->number <= last_number_) {
      throw std::logic_error("pushed scans in another order than they were observed in");
    }
    last_number_ = scan->number;
    ++pushed_;
    return *scan;
  }

  void finish() { finished_ = true; }
  std::size_t pushed() const { return pushed_; }

 private:
  std::optional<std::size_t> scan_count_;
  std::size_t observed_ = 0, pushed_ = 0, last_number_ = 0;
  bool finished_ = false;
};

/// Returns the context. Throws std::invalid_argument for 0 threads.
inline const RunContext& checked(const RunContext& context) {
  if (context.threads == 0) throw std::invalid_argument("threads: 0, expected at least 1");
  return context;
}

/// Throws std::range_error for a pose that is not finite, or whose rotation departs from an
/// orthonormal right-handed one by more than a thousandth.
void check_rigid(const Pose& pose);

}  // namespace mosbench
