#include "datasets/sequence/stamps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kScans = 8;

/// Scans called by these numbers, with what their folder says of stamps.
Recording stamped(const std::vector<std::string>& stems, const std::string& times_txt = "") {
  const TempFolder folder;
  if (!times_txt.empty()) folder.write("times.txt", times_txt);
  Recording recording;
  for (const std::string& stem : stems) recording.scans.emplace_back().stem = stem;
  read_stamps(folder.path(), recording);
  return recording;
}

Recording stamped(const std::vector<std::uint64_t>& numbers, const std::string& times_txt = "") {
  std::vector<std::string> stems;
  for (const std::uint64_t number : numbers) stems.push_back(std::to_string(number));
  return stamped(stems, times_txt);
}

std::vector<std::uint64_t> numbers(std::uint64_t first, std::uint64_t step) {
  std::vector<std::uint64_t> stems;
  for (std::size_t k = 0; k < kScans; ++k) stems.push_back(first + k * step);
  return stems;
}

void expect_stamps(const Recording& recording, std::int64_t first_ns, std::int64_t step_ns) {
  for (std::size_t k = 0; k < kScans; ++k) {
    ASSERT_EQ(recording.scans[k].stamp_ns, first_ns + static_cast<std::int64_t>(k) * step_ns);
  }
}

TEST(Stamps, InNamesAreTakenInTheUnitOfTheirSteps) {
  constexpr std::int64_t kSince1970_ns = 1'700'000'000'000'000'000, kSinceBoot_ns = 50'000'000'000;
  for (const std::int64_t step_ns : {50'000'000, 100'000'000, 1'000'000'000}) {
    for (const std::int64_t start_ns : {kSince1970_ns, kSinceBoot_ns}) {
      for (const std::int64_t unit_ns : {1, 1'000}) {
        const Recording recording = stamped(numbers(static_cast<std::uint64_t>(start_ns / unit_ns),
                                                    static_cast<std::uint64_t>(step_ns / unit_ns)));
        expect_stamps(recording, start_ns, step_ns);
        EXPECT_EQ(recording.reading.stamps, unit_ns == 1 ? "" : "us");
        EXPECT_EQ(recording.doubts.size(), unit_ns == 1 ? 0U : 1U);
      }
    }
    const auto ms = static_cast<std::uint64_t>(step_ns / 1'000'000);
    expect_stamps(stamped(numbers(1'700'000'000'000, ms)), kSince1970_ns, step_ns);
  }
}

TEST(Stamps, AreNotTheNumbersOfScans) {
  for (const std::uint64_t first : {0U, 1U, 4000U, 20'000'000U, 2'011'092'600U}) {
    for (const std::uint64_t step : {1U, 2U, 5U, 10U, 100U}) {
      const Recording recording = stamped(numbers(first, step));
      for (const ScanEntry& scan : recording.scans) EXPECT_FALSE(scan.stamp_ns) << first;
    }
  }
  EXPECT_FALSE(stamped(numbers(2'011'092'600'001, 1)).scans[0].stamp_ns);
}

TEST(Stamps, InNamesOfSecondsAndTheirDecimalsAreBoth) {
  using Form = std::string (*)(std::size_t);
  const std::string since_1970 = "1700000000";
  for (const auto form : std::initializer_list<Form>{
           [](std::size_t k) { return "." + std::to_string(k); },
           [](std::size_t k) { return "." + std::to_string(k) + "00000000"; },
           [](std::size_t k) { return "_" + std::to_string(k) + "00000000"; }}) {
    std::vector<std::string> stems;
    for (std::size_t k = 0; k < kScans; ++k) stems.push_back(since_1970 + form(k));
    const Recording recording = stamped(stems);
    expect_stamps(recording, 1'700'000'000'000'000'000, 100'000'000);
    EXPECT_EQ(recording.reading.stamps, "s");
    EXPECT_EQ(recording.doubts.size(), 1U) << "the choice is said";
    stems.back() = "last";
    EXPECT_FALSE(stamped(stems).scans[0].stamp_ns);
  }
  for (const std::string stem : {"000012_000000001", "1700000000_000001", "1700000000.x", "0.1"}) {
    EXPECT_FALSE(stamped(std::vector<std::string>{stem}).scans[0].stamp_ns) << stem;
  }
}

TEST(Stamps, OfNanosecondsWithoutTheirZerosAreRefused) {
  std::vector<std::string> padded, unpadded, shortened;
  for (std::size_t k = 0; k < kScans; ++k) {
    const std::string ns = std::to_string(20'000'000 + k * 100'000'000);
    unpadded.push_back("1700000000." + ns);
    padded.push_back("1700000000." + std::string(9 - ns.size(), '0') + ns);
    shortened.push_back(padded.back().substr(0, 13));
  }
  EXPECT_THAT(message_of<DataError>([&] { stamped(unpadded); }),
              testing::AllOf(HasSubstr("1700000000.20000000: seems to be called by seconds and"),
                             HasSubstr("expected nine digits in every name")));
  expect_stamps(stamped(padded), 1'700'000'000'020'000'000, 100'000'000);
  expect_stamps(stamped(shortened), 1'700'000'000'020'000'000, 100'000'000);
  // A fraction without the zeros at its end.
  EXPECT_EQ(
      stamped(std::vector<std::string>{"1700000000.5", "1700000000.599999999"}).scans[1].stamp_ns,
      1'700'000'000'599'999'999);
}

TEST(Stamps, OfTimesTxtAreSecondsUnlessTheirStepsSayOtherwise) {
  for (const auto& [zeros, unit] :
       {std::pair{"", "s"}, {"00", "ms"}, {"00000", "us"}, {"00000000", "ns"}}) {
    for (const char* since : {"", "17000000"}) {
      std::string text;
      for (std::size_t k = 0; k < kScans; ++k) {
        const std::string tenths = since + std::to_string(10 + k);
        // One digit before the last is that of a second.
        text += unit == std::string("s") ? tenths.substr(0, tenths.size() - 1) + "." + tenths.back()
                                         : tenths + zeros;
        text += "\n";
      }
      const Recording recording = stamped(numbers(0, 1), text);
      for (std::size_t k = 1; k < kScans; ++k) {
        ASSERT_EQ(*recording.scans[k].stamp_ns - *recording.scans[k - 1].stamp_ns, 100'000'000)
            << unit << since;
      }
      EXPECT_EQ(recording.reading.stamps, unit == std::string("s") ? "" : unit);
    }
  }
  EXPECT_THAT(stamped(numbers(0, 1), "0\n0\n0\n0\n0\n0\n0\n0\n").doubts, IsEmpty());
}

TEST(Stamps, TellTheUsualStepUnlessItCannotBe) {
  for (const double step_s : {1e-4, 0.0, 100.0}) {
    std::string text;
    for (std::size_t k = 0; k < kScans; ++k) {
      text += std::to_string(static_cast<double>(k) * step_s) + "\n";
    }
    Recording recording = stamped(numbers(0, 1), text);
    const auto usual = usual_step_s(recording.scans);
    EXPECT_EQ(usual.has_value(), step_s > 1.0) << step_s;  // 100 s are taken as ms
    EXPECT_NEAR(usual.value_or(0.1), 0.1, 1e-9);
  }
}

}  // namespace
}  // namespace mosbench
