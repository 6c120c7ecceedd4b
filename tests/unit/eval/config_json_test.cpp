#include "eval/results/config_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/files/errors.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/runs/presets.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

std::string refusal(std::string_view text) {
  return message_of<UsageError>([&] {
    Config config;
    apply_config_text(text, "near.json", config);
  });
}

TEST(ConfigJson, WritesWhatItReads) {
  Config config;
  config.voxel_size_m = 0.1;
  config.occupancy_sigma_m = 0.3;
  config.delay_scans = 7;
  config.distance_field_scans = 1;
  Config read;
  apply_config_text(to_json(config, Variant::kPaper2024).dump(), "written", read);
  EXPECT_EQ(to_json(read, Variant::kPaper2024), to_json(config, Variant::kPaper2024));
  EXPECT_EQ(read.distance_field_scans, 1);
}

TEST(ConfigJson, LetsSigmaFollowTheVoxelSizeUntilItIsSet) {
  Config config;
  apply_config_assignment("voxel_size_m=0.4", config);
  EXPECT_EQ(to_json(config, Variant::kPaper2024).at("occupancy_sigma_m"), 0.4);
  apply_config_assignment("occupancy_sigma_m=0.1", config);
  apply_config_assignment("voxel_size_m=0.5", config);
  EXPECT_EQ(to_json(config, Variant::kPaper2024).at("occupancy_sigma_m"), 0.1);
}

TEST(ConfigJson, ShowsTheDistanceFieldOnlyWhenItIsNotTheDefault) {
  Config config;
  EXPECT_EQ(to_json(config, Variant::kPaper2024).size(), 12U);
  config.distance_field_scans = 1;
  EXPECT_EQ(to_json(config, Variant::kPaper2024).at("distance_field_scans"), 1);
}

TEST(ConfigJson, LeavesOutTheWindowThatTheLaterProgramDoesNotHave) {
  EXPECT_EQ(to_json(Config{}, Variant::kRelease2025).size(), 11U);
  EXPECT_FALSE(to_json(Config{}, Variant::kRelease2025).contains("dynamic_window_scans"));
}

TEST(ConfigJson, TakesAWholeNumberForALength) {
  Config config;
  apply_config_text(R"({"max_range_m": 50})", "near.json", config);
  EXPECT_EQ(config.max_range_m, 50.0);
}

TEST(ConfigJson, NamesFileKeyAndExpectation) {
  EXPECT_THAT(refusal(R"({"max_rang_m": 50})"),
              HasSubstr("near.json: key 'max_rang_m' is not known"));
  EXPECT_THAT(refusal(R"({"max_rang_m": 50})"), HasSubstr("nearest: max_range_m"));
  EXPECT_EQ(refusal(R"({"max_range_m": true})"),
            "near.json: max_range_m: true is not a number, expected 0.1 to 1000");
  EXPECT_EQ(refusal(R"({"max_range_m": null})"),
            "near.json: max_range_m: null is not a number, expected 0.1 to 1000");
  EXPECT_EQ(refusal(R"({"min_otsu_score": 3.0})"),
            "near.json: min_otsu_score: 3.0 is not a whole number, expected 0 to 1000000");
  EXPECT_EQ(refusal(R"({"max_range_m": 1e400})").substr(0, 10), "near.json:");
  EXPECT_THAT(refusal("nonsense"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(refusal("\xff\xfe"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(refusal("{\"\xff\": 1}"), HasSubstr("expected a JSON object"));
}

TEST(Presets, HaveThePapersSettingsAndAKnownProtocol) {
  for (const Preset& preset : presets()) {
    EXPECT_NO_THROW(check(preset.config)) << preset.name;
    EXPECT_NE(find_protocol(preset.protocol), nullptr) << preset.name;
    EXPECT_EQ(&preset_named(preset.name), &preset);
  }
  EXPECT_EQ(preset_named("doals-20m").config.max_range_m, 20.0);
  EXPECT_EQ(preset_named("doals-120m").config.max_range_m, 120.0);
  EXPECT_EQ(preset_named("sipailou").config.min_range_m, 3.0);
  EXPECT_EQ(preset_named("helimos").config.voxel_size_m, 0.25);
  EXPECT_EQ(preset_named("helimos-delayed").config.delay_scans, 10);
  EXPECT_EQ(default_preset(DatasetKind::kHelimos).name, "helimos");
  EXPECT_EQ(default_preset(DatasetKind::kDoals).name, "doals-20m");
}

}  // namespace
}  // namespace mosbench
