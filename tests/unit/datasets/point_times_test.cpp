#include "datasets/formats/point_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/ply_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// How a driver keeps the times of a sweep that lasts a tenth of a second.
struct Stored {
  double per_s = 1.0;        ///< units in a second
  bool since_stamp = true;   ///< or by the clock of the stamps
  double clock_off_s = 0.0;  ///< of the points' clock from that of the stamps
  double from_s = 0.0;       ///< of the first point, after the stamp
  bool as_float32 = false;
};

constexpr std::size_t kPoints = 200, kScans = 12;

double after_stamp_s(const Stored& stored, std::size_t i) {
  return stored.from_s + 0.1 * static_cast<double>(i) / (kPoints - 1);
}

std::vector<StoredTimes> scans_of(const Stored& stored, double start_s) {
  std::vector<StoredTimes> scans;
  for (std::size_t k = 0; k < kScans; ++k) {
    const double stamp_s = start_s + 0.1 * static_cast<double>(k);
    StoredTimes& scan = scans.emplace_back();
    scan.stamp_ns = std::llround(stamp_s * 1e9);
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double time =
          ((stored.since_stamp ? 0.0 : stamp_s + stored.clock_off_s) + after_stamp_s(stored, i)) *
          stored.per_s;
      scan.times.push_back(stored.as_float32 ? static_cast<double>(static_cast<float>(time))
                                             : time);
    }
  }
  return scans;
}

/// The largest error in nanoseconds of the points that have a time; their number in `timed`.
double worst_ns(const PointClock& clock, const Stored& stored,
                const std::vector<StoredTimes>& scans, std::size_t& timed) {
  double worst = 0.0;
  for (const StoredTimes& scan : scans) {
    const auto times_ns = clock.after_stamp_ns(scan);
    for (std::size_t i = 0; i < times_ns.size(); ++i) {
      if (times_ns[i] == kNoTime) continue;
      ++timed;
      worst = std::max(worst,
                       std::abs(static_cast<double>(times_ns[i]) - 1e9 * after_stamp_s(stored, i)));
    }
  }
  return worst;
}

void expect_all(const Stored& stored, double start_s, double tolerance_ns, const char* text) {
  const auto scans = scans_of(stored, start_s);
  const PointClock clock(scans, 0.1);
  std::size_t timed = 0;
  EXPECT_LE(worst_ns(clock, stored, scans, timed), tolerance_ns) << text;
  EXPECT_EQ(timed, kPoints * kScans) << text;
  EXPECT_THAT(clock.text(), HasSubstr(text));
  EXPECT_EQ(clock.doubt(), "");
}

TEST(PointTimes, AreToldInEveryUnitAndClock) {
  for (const auto& [per_s, unit] : {std::pair{1.0, "s"}, {1e3, "ms"}, {1e6, "us"}, {1e9, "ns"}}) {
    for (const double from_s : {0.0, -0.05, -0.1}) {
      for (const double start_s : {0.0, 0.3, 2.0, 5e3, 1.7e9}) {
        const double rounding_ns = 1e9 * start_s * 0x1p-51 + 1.0;
        expect_all({.per_s = per_s, .from_s = from_s}, start_s, 1.0, unit);
        expect_all({.per_s = per_s, .from_s = from_s, .as_float32 = true}, start_s, 10.0, unit);
        expect_all({.per_s = per_s, .since_stamp = false, .from_s = from_s}, start_s, rounding_ns,
                   unit);
      }
    }
    expect_all({.per_s = per_s, .since_stamp = false, .clock_off_s = 1.7e9}, 5e3, 2000.0,
               "by another clock");
  }
}

TEST(PointTimes, FromZeroToOneAreSharesOfTheTimeBetweenScans) {
  const Stored stored{.per_s = 10.0};
  expect_all(stored, 1.7e9, 1.0, "shares of the time between scans");
  const auto scans = scans_of(stored, 1.7e9);
  EXPECT_TRUE(PointClock(scans, 0.1).is_odd());
  EXPECT_FALSE(PointClock(scans, std::nullopt).knows_unit()) << "a second, or shares of less";
  EXPECT_THAT(PointClock(scans, std::nullopt, TimeUnit::kSeconds).text(), HasSubstr("s since"));
}

TEST(PointTimes, ThatAreOffLeaveTheOthers) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 4294667296.0, -1.0e18, 1e30,
                           std::numeric_limits<double>::infinity()}) {
    for (const std::size_t at : {std::size_t{0}, kPoints / 2, kPoints - 1}) {
      for (const std::size_t count : {1U, 6U, 90U}) {
        const Stored stored{.per_s = 1e9};
        auto scans = scans_of(stored, 1.7e9);
        for (std::size_t i = 0; i < count; ++i) {
          scans[at % kScans].times[(at + 2 * i) % kPoints] = bad;
        }
        const PointClock clock(scans, 0.1);
        std::size_t timed = 0;
        EXPECT_LE(worst_ns(clock, stored, scans, timed), 1.0) << bad;
        EXPECT_EQ(timed, kPoints * kScans - count) << bad << " " << at;
        EXPECT_THAT(clock.doubt(), HasSubstr(counted(count, "point") + " in 1 scan,"));
      }
    }
  }
}

TEST(PointTimes, OfMissingReturnsMayBeZeroInMostOfAScan) {
  const Stored stored{.since_stamp = false};
  auto scans = scans_of(stored, 1.7e9);
  for (StoredTimes& scan : scans) {
    for (std::size_t i = 0; i < scan.times.size(); ++i) {
      if (i % 5 < 3) scan.times[i] = 0.0;
    }
  }
  std::size_t timed = 0;
  EXPECT_LE(worst_ns(PointClock(scans, 0.1), stored, scans, timed), 400.0);
  EXPECT_EQ(timed, kPoints * kScans * 2 / 5);
}

TEST(PointTimes, OfAScanThatIsOffLeaveItAsItWasMeasured) {
  for (const std::size_t at : {std::size_t{0}, std::size_t{5}, kScans - 1}) {
    auto scans = scans_of({.per_s = 1e9}, 1.7e9);
    for (double& time : scans[at].times) time *= 36.0;
    const PointClock clock(scans, 0.1);
    EXPECT_TRUE(clock.after_stamp_ns(scans[at]).empty());
    EXPECT_EQ(clock.after_stamp_ns(scans[(at + 1) % kScans]).size(), kPoints);
    EXPECT_THAT(clock.doubt(), HasSubstr("times of 1 whole scan, of 12 scans"));
  }
}

TEST(PointTimes, OfSweepsThatAreLongerThanTheStepAreNotUsed) {
  for (const double times_longer : {2.0, 3.0, 5.0, 30.0}) {
    for (const double per_s : {1e3, 1e9}) {
      const auto scans = scans_of({.per_s = times_longer * per_s}, 1.7e9);
      EXPECT_FALSE(PointClock(scans, 0.1).knows_unit()) << times_longer;
    }
  }
}

TEST(PointTimes, OfNoSweepAreNotUsed) {
  for (const double per_s : {3e-3, 20.0, 1e4, 2e-5, 1e15}) {
    const auto scans = scans_of({.per_s = per_s}, 1.7e9);
    const PointClock clock(scans, 0.1);
    EXPECT_FALSE(clock.knows_unit()) << per_s;
    EXPECT_TRUE(clock.after_stamp_ns(scans[0]).empty());
    EXPECT_THAT(clock.text(), HasSubstr("not used, they span"));
    EXPECT_TRUE(clock.is_odd());
  }
  for (const auto& same : {scans_of({.per_s = 0.0}, 1.7e9), std::vector<StoredTimes>()}) {
    EXPECT_FALSE(PointClock(same, 0.1).knows_unit());
    EXPECT_FALSE(PointClock(same, 0.1).is_odd()) << "they say nothing";
  }
  auto rounded = scans_of({.per_s = 0.0}, 1.7e9);
  for (StoredTimes& scan : rounded) std::ranges::fill(scan.times, 1.7e9);
  EXPECT_TRUE(PointClock(rounded, 0.1).is_odd());
}

TEST(PointTimes, ThatAreAllZeroInOneScanAreSaid) {
  auto scans = scans_of({.per_s = 1e9}, 1.7e9);
  EXPECT_EQ(PointClock(scans, 0.1).doubt(), "");
  std::ranges::fill(scans[7].times, 0.0);
  EXPECT_THAT(PointClock(scans, 0.1).doubt(), HasSubstr("times of 1 whole scan, of 12 scans"));
}

/// Two points with fields of float64.
std::vector<double> times_in_fields(
    const std::vector<std::pair<const char*, std::array<double, 2>>>& fields) {
  CloudHead head;
  ByteSink records;
  for (const auto& [name, numbers] : fields) {
    head.fields.push_back({name, static_cast<std::uint32_t>(8 * head.fields.size()), 8, 1});
  }
  for (const std::size_t point : {0U, 1U}) {
    for (const auto& [name, numbers] : fields) records.put(numbers[point]);
  }
  head.point_step_bytes = static_cast<std::uint32_t>(8 * fields.size());
  head.height = 1;
  head.width = 2;
  head.row_step_bytes = 2 * head.point_step_bytes;
  return times_of(head, std::move(records).bytes(), "f");
}

TEST(PointTimes, AreThoseOfTheFieldThatDiffersOrTheSumOfSecondsAndNanoseconds) {
  EXPECT_THAT(times_in_fields({{"time", {0, 0}}, {"timestamp", {5, 6}}}), ElementsAre(5, 6));
  EXPECT_THAT(times_in_fields({{"time", {1, 2}}, {"timestamp", {5, 6}}}), ElementsAre(1, 2));
  EXPECT_THAT(times_in_fields({{"time", {3, 3}}, {"timestamp", {0, 0}}}), ElementsAre(3, 3));
  EXPECT_THAT(times_in_fields({{"timeSecond", {7, 8}}, {"timeNanosecond", {9e8, 0}}}),
              ElementsAre(7.9e9, 8e9));
  EXPECT_THAT(times_in_fields({{"timestamp_nsec", {64, 128}}}), ElementsAre(64, 128));
  EXPECT_THAT(times_in_fields({{"ring", {1, 2}}}), testing::IsEmpty());
}

TEST(PointTimes, StandInTheFieldWithAUsualNameWhereThereAreSeveral) {
  CloudHead head;
  for (const char* name : {"x", "stamp_of_packet", "t", "time_of_day"}) {
    head.fields.push_back({name, 0, 7, 1});
  }
  EXPECT_EQ(find_time_field(head)->name, "t");
  std::erase_if(head.fields, [](const CloudField& field) { return field.name == "t"; });
  EXPECT_EQ(find_time_field(head)->name, "stamp_of_packet");
}

TEST(PointTimes, StandInAPropertyOfPlyFiles) {
  const auto ascii = [](const std::string& name) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty uint " + name +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
           "4000000000 1 2 3\n4100000000 4 5 6\n";
  };
  for (const char* name :
       {"t", "time", "timestamp", "offset_time", "time_stamp", "ts", "timeStamp", "TIME", "t_us",
        "t_ns", "time_offset_us", "dt", "delta_t", "GpsTime", "stamp", "point_time_offset"}) {
    const std::string bytes = ascii(name);
    EXPECT_TRUE(parse_ply_summary(bytes, bytes.size(), "f").has_times);
    EXPECT_THAT(parse_ply_times(bytes, "f"), ElementsAre(4e9, 4.1e9));
  }
  for (const char* name : {"ring", "intensity", "tag", "nir", "curvature", "red"}) {
    EXPECT_FALSE(is_time_field(name)) << name;
  }
  const std::string without = ascii("ring");
  EXPECT_FALSE(parse_ply_summary(without, without.size(), "f").has_times);
  EXPECT_THAT(message_of<DataError>([&] { parse_ply_times(without, "f"); }),
              HasSubstr("f: the points have no times, expected a field t, time, timestamp"));
}

}  // namespace
}  // namespace mosbench
