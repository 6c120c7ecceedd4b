#include "core/config.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

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

TEST(Variant, NamesReadBackAsThemselves) {
  EXPECT_EQ(variant_from_string("paper-2024"), Variant::kPaper2024);
  EXPECT_EQ(variant_from_string("release-2025"), Variant::kRelease2025);
  EXPECT_EQ(variant_from_string("paper"), std::nullopt);
}

}  // namespace
}  // namespace mosbench
