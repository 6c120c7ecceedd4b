#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStamp_ns = 1'700'000'000'000'000'000;

std::string error_of(const std::vector<double>& stored) {
  return message_of<DataError>([&] { times_after_stamp_ns(stored, std::nullopt, "f.ply"); });
}

TEST(PointTimes, AreToldFromTheirSpanInEveryUnit) {
  for (const double per_s : {1.0, 1e3, 1e6, 1e9}) {
    EXPECT_THAT(times_after_stamp_ns(std::vector{0.05 * per_s, -0.05 * per_s, 0.0}, kStamp_ns, "f"),
                ElementsAre(50'000'000, -50'000'000, 0));
  }
}

TEST(PointTimes, SinceAnEpochAreTakenAfterTheStampOrTheFirstOfThem) {
  const std::vector<double> ns = {1.7e18 + 1.28e8, 1.7e18 + 0.28e8};
  EXPECT_THAT(times_after_stamp_ns(ns, kStamp_ns, "f"), ElementsAre(128'000'000, 28'000'000));
  EXPECT_THAT(times_after_stamp_ns(ns, std::nullopt, "f"), ElementsAre(100'000'000, 0));
  EXPECT_THAT(times_after_stamp_ns(ns, 5'000'000'000, "f"), ElementsAre(100'000'000, 0));
  EXPECT_THAT(times_after_stamp_ns(std::vector{1.7e9, 1.7e9 + 0.0625}, kStamp_ns, "f"),
              ElementsAre(0, 62'500'000));
}

TEST(PointTimes, OfLessThanTwoPointsAreTheStamp) {
  EXPECT_THAT(times_after_stamp_ns({}, kStamp_ns, "f"), ElementsAre());
  EXPECT_THAT(times_after_stamp_ns(std::vector{7e5}, kStamp_ns, "f"), ElementsAre(0));
}

TEST(PointTimes, ThatNoScanHasAreRefused) {
  EXPECT_THAT(error_of({3.0, 3.0}), HasSubstr("f.ply: the times of its points span 0, expected"));
  EXPECT_THAT(error_of({0.0, 3e-4}), HasSubstr("span 0.0003"));
  EXPECT_THAT(error_of({0.0, 3e9}), HasSubstr("span 3e+09"));
  EXPECT_THAT(error_of({-1.7e308, 1.7e308}), HasSubstr("span inf"));
  EXPECT_THAT(error_of({0.0, 0.1, std::numeric_limits<double>::quiet_NaN()}),
              HasSubstr("f.ply: point 2 has no finite time"));
}

TEST(PointTimes, StandInAPropertyOfPlyFiles) {
  const auto ascii = [](const std::string& name) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty uint " + name +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
           "4000000000 1 2 3\n4100000000 4 5 6\n";
  };
  for (const char* name : {"t", "time", "timestamp", "offset_time"}) {
    const std::string bytes = ascii(name);
    EXPECT_TRUE(parse_ply_summary(bytes, bytes.size(), "f").has_times);
    EXPECT_THAT(parse_ply_times(bytes, "f"), ElementsAre(4e9, 4.1e9));
  }
  const std::string without = ascii("ring");
  EXPECT_FALSE(parse_ply_summary(without, without.size(), "f").has_times);
  EXPECT_THAT(message_of<DataError>([&] { parse_ply_times(without, "f"); }),
              HasSubstr("f: the points have no times, expected a field t, time, timestamp"));
}

}  // namespace
}  // namespace mosbench
