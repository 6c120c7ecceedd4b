#include "core/methods/hmm_mos/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace mosbench {
using namespace hmm_mos;
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
  visit_fields(defaults, [&](std::string_view name, const auto&, const auto& range, auto) {
    ++fields;
    if constexpr (std::is_same_v<std::decay_t<decltype(range)>, FieldRange>) {
      for (const double bad : {std::nextafter(range.lowest, -1e9) - 1, range.highest + 1}) {
        Config config;
        visit_fields(config, [&](std::string_view other, auto& value, const auto&, auto) {
          using Value = std::decay_t<decltype(value)>;
          if (other != name) return;
          if constexpr (std::is_same_v<Value, int>) {
            value = static_cast<int>(bad);
          } else if constexpr (!std::is_enum_v<Value>) {
            value = bad;
          }
        });
        EXPECT_THAT(complaint_about(config), testing::StartsWith(std::string(name) + ": "));
      }
    }
  });
  EXPECT_EQ(fields, 15U);
}

TEST(Config, HasAWindowOfTracksOfASecondOrMoreInsteadOfADelay) {
  Config config;
  config.track_window_s = 0.5;
  EXPECT_EQ(complaint_about(config), "track_window_s: is less than 1 s, expected 0 or 1 to 3600");
  config.track_window_s = 1;
  EXPECT_EQ(complaint_about(config), "");
  config.delay_scans = 1;
  EXPECT_EQ(complaint_about(config),
            "delay_scans: is set beside track_window_s, expected delay=1, which judges no whole "
            "tracks");
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

TEST(Config, BecomesSettingsAndBack) {
  Config config;
  config.variant = Variant::kRelease2025;
  config.occupancy_sigma_m = 0.3;
  config.kernel_width_voxels = 7;
  const Settings settings = settings_of(config);
  EXPECT_EQ(settings.choice("variant"), "release-2025");
  EXPECT_EQ(settings.number("occupancy_sigma_m"), 0.3);
  const Config back = config_of<Config>(settings);
  EXPECT_EQ(back.variant, Variant::kRelease2025);
  EXPECT_EQ(back.occupancy_sigma_m, 0.3);
  EXPECT_EQ(back.kernel_width_voxels, 7);
  EXPECT_EQ(config_of<Config>(settings_of(Config{})).occupancy_sigma_m, std::nullopt);
}

TEST(Settings, RefuseUnknownNamesOtherTypesAndValuesOutOfRange) {
  Settings settings = settings_of(Config{});
  EXPECT_THROW(settings.set("voxel_size", 0.2), std::invalid_argument);
  EXPECT_THROW(settings.set("voxel_size_m", std::string("big")), std::invalid_argument);
  EXPECT_THROW(settings.set("delay_scans", 1.0), std::invalid_argument);
  EXPECT_THROW(settings.set("delay_scans", -1), std::invalid_argument);
  EXPECT_THROW(settings.set("variant", std::string("paper")), std::invalid_argument);
  EXPECT_THROW((void)settings.whole("voxel_size_m"), std::invalid_argument);
  EXPECT_THROW((void)settings.choice("delay_scans"), std::invalid_argument);
  EXPECT_THROW((void)settings.number("variant"), std::invalid_argument);
  settings.set("voxel_size_m", 1);
  EXPECT_EQ(settings.number("occupancy_sigma_m"), 1.0) << "follows the voxel size";
}

}  // namespace
}  // namespace mosbench
