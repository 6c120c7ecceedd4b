#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "eval/engine/score_execute.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kScans = 60;
constexpr std::size_t kPoints = 400;

/// Points 5 k to 5 k + 19 move in scan k.
std::vector<std::uint32_t> labels_of(std::size_t k) {
  std::vector<std::uint32_t> labels(kPoints, kStaticLabel);
  for (std::size_t i = 0; i < 20; ++i) labels[5 * k + i] = kMovingLabel;
  return labels;
}

class Passing : public Sequence {
 public:
  Passing() {
    for (std::size_t k = 0; k < kScans; ++k) {
      ScanEntry scan;
      scan.stem = std::to_string(k);
      scan.points = kPoints;
      scan.has_truth = true;
      mutable_recording().scans.push_back(scan);
    }
  }
  using Sequence::read;
  void read(std::size_t k, Frame& frame) const override {
    frame = {};
    frame.truth = read_truth(k);
  }
  std::vector<std::uint32_t> read_truth(std::size_t k) const override { return labels_of(k); }
};

/// The true labels of `shift` scans earlier.
class Shifted : public Predictions {
 public:
  explicit Shifted(int shift) : shift_(shift) {}
  bool has(std::size_t) const override { return true; }
  std::vector<std::uint32_t> read(std::size_t k) const override {
    const int of = static_cast<int>(k) - shift_;
    return labels_of(static_cast<std::size_t>(std::clamp(of, 0, static_cast<int>(kScans) - 1)));
  }

 private:
  int shift_;
};

std::string remark_on(int shift) {
  std::vector<std::size_t> scans(kScans);
  std::iota(scans.begin(), scans.end(), 0U);
  const Protocol& protocol = protocol_named("sipailou");
  return shift_remark(Passing(), scans, Shifted(shift), {&protocol, protocol.default_range});
}

TEST(ShiftRemark, NamesTheShift) {
  EXPECT_EQ(remark_on(0), "");
  EXPECT_THAT(remark_on(1),
              testing::StartsWith("labels look 1 scan late: those of 1 scan later "
                                  "fit the truth better, IoU 100.0 in place of 60.0 %"));
  EXPECT_THAT(remark_on(10), testing::HasSubstr("a method with a delay of 10 scans"));
  EXPECT_THAT(remark_on(-3), testing::StartsWith("labels look 3 scans early"));
  EXPECT_THAT(remark_on(-3), testing::Not(testing::HasSubstr("delay")));
}

}  // namespace
}  // namespace mosbench
