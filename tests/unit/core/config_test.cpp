#include "core/hmm_mos/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace mosbench {
namespace {

TEST(Config, DefaultsAreThePapersAndLegal) {
  const Config config;
  EXPECT_NO_THROW(check(config));
  EXPECT_EQ(config.sigma_m(), config.voxel_size_m);
  EXPECT_EQ(config.min_state_probability, 0.99);
  EXPECT_EQ(config.transition_epsilon, 0.005);
  EXPECT_EQ(config.kernel_width_voxels, 5);
}

TEST(Config, RefusesValuesOutOfRange) {
  Config even;
  even.kernel_width_voxels = 4;
  EXPECT_THROW(check(even), std::invalid_argument);
  Config no_window;
  no_window.local_window_scans = 0;
  EXPECT_THROW(check(no_window), std::invalid_argument);
  Config crossed;
  crossed.min_range_m = 30.0;
  EXPECT_THROW(check(crossed), std::invalid_argument);
}

std::string complaint_about(const Config& config) {
  try {
    check(config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

/// Every field's limits belong to the range, the next number beyond does not; the complaint starts
/// with the key.
TEST(Config, LimitsAreClosedAndComplaintsNameTheKey) {
  std::size_t fields = 0;
  const Config defaults;
  visit_fields(defaults, [&](std::string_view name, const auto&, FieldRange range) {
    ++fields;
    for (const double bad : {std::nextafter(range.lowest, -1e9) - 1, range.highest + 1}) {
      Config config;
      visit_fields(config, [&](std::string_view other, auto& value, FieldRange) {
        using Value = std::decay_t<decltype(value)>;
        if (other != name) return;
        if constexpr (std::is_same_v<Value, int>) {
          value = static_cast<int>(bad);
        } else {
          value = bad;
        }
      });
      EXPECT_THAT(complaint_about(config), testing::StartsWith(std::string(name) + ": "));
    }
  });
  EXPECT_EQ(fields, 13U);
}

TEST(Config, RefusesNumbersThatAreNone) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Config config;
    config.voxel_size_m = bad;
    EXPECT_THAT(complaint_about(config), testing::StartsWith("voxel_size_m: "));
    config = {};
    config.occupancy_sigma_m = bad;
    EXPECT_THAT(complaint_about(config), testing::StartsWith("occupancy_sigma_m: "));
  }
}

/// The distance field reaches 28 voxels, the ray caster 1500: more would be computed wrongly.
TEST(Config, RefusesSigmasAndRangesOfTooManyVoxels) {
  Config config;
  config.occupancy_sigma_m = 0.9;
  EXPECT_EQ(complaint_about(config), "");
  config.occupancy_sigma_m = 1.0;
  EXPECT_THAT(complaint_about(config), testing::StartsWith("occupancy_sigma_m: "));
  config = {};
  config.max_range_m = 300.0;
  EXPECT_EQ(complaint_about(config), "");
  config.max_range_m = 300.1;
  EXPECT_THAT(complaint_about(config), testing::StartsWith("max_range_m: "));
}

TEST(Variant, NamesReadBackAsThemselves) {
  EXPECT_EQ(variant_from_string("paper-2024"), Variant::kPaper2024);
  EXPECT_EQ(variant_from_string("release-2025"), Variant::kRelease2025);
  EXPECT_EQ(variant_from_string("paper"), std::nullopt);
}

}  // namespace
}  // namespace mosbench
