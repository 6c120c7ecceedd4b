#include "eval/result/settings_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mosbench/method.hpp>
#include <set>

#include "datasets/layouts/layout.hpp"
#include "datasets/text/errors.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/protocol.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

Settings defaults() { return find_method("hmm-mos")->defaults; }

std::string refusal(std::string_view text) {
  return message_of<UsageError>([&] {
    Settings settings = defaults();
    apply_settings_text(text, "near.json", settings);
  });
}

TEST(SettingsJson, WritesWhatItReads) {
  Settings settings = defaults();
  settings.set("variant", std::string("release-2025"));
  settings.set("voxel_size_m", 0.1);
  settings.set("occupancy_sigma_m", 0.3);
  settings.set("delay_scans", 7);
  settings.set("distance_field_scans", 1);
  Settings read = defaults();
  apply_settings_text(to_json(settings).dump(), "written", read);
  EXPECT_EQ(to_json(read), to_json(settings));
  EXPECT_EQ(read.whole("distance_field_scans"), 1);
  EXPECT_EQ(read.choice("variant"), "release-2025");
}

TEST(SettingsJson, HoldsEverySettingAlsoThoseThatKeepTheirDefault) {
  const Settings settings = defaults();
  const nlohmann::ordered_json json = to_json(settings);
  ASSERT_EQ(json.size(), settings.all().size());
  for (const Setting& setting : settings.all()) {
    EXPECT_TRUE(json.contains(std::string(setting.name))) << setting.name;
  }
}

TEST(SettingsJson, LetsSigmaFollowTheVoxelSizeUntilItIsSet) {
  Settings settings = defaults();
  apply_setting_assignment("voxel_size_m=0.4", settings);
  EXPECT_EQ(to_json(settings).at("occupancy_sigma_m"), 0.4);
  apply_setting_assignment("occupancy_sigma_m=0.1", settings);
  apply_setting_assignment("voxel_size_m=0.5", settings);
  EXPECT_EQ(to_json(settings).at("occupancy_sigma_m"), 0.1);
}

TEST(SettingsJson, TakesAWholeNumberForALength) {
  Settings settings = defaults();
  apply_settings_text(R"({"max_range_m": 50})", "near.json", settings);
  EXPECT_EQ(settings.number("max_range_m"), 50.0);
}

TEST(SettingsJson, TakesAVariantByItsName) {
  Settings settings = defaults();
  apply_setting_assignment("variant=release-2025", settings);
  EXPECT_EQ(settings.choice("variant"), "release-2025");
  EXPECT_EQ(refusal(R"({"variant": "release"})"),
            "near.json: variant: release is not known, expected paper-2024 or release-2025");
  EXPECT_EQ(refusal(R"({"variant": 3})"),
            "near.json: variant: 3 is not known, expected paper-2024 or release-2025");
}

TEST(SettingsJson, DescribesWhatUsersAskForAndWhatIsNotTheDefault) {
  Settings settings = defaults();
  settings.set("min_otsu_score", 4);
  EXPECT_EQ(describe_settings(RecordedSettings(settings), "hmm-mos"),
            "paper-2024, voxel 0.2 m, range 0.5 to 20 m, online, min_otsu_score 4");
  settings.set("occupancy_sigma_m", 0.3);
  EXPECT_EQ(describe_settings(RecordedSettings(settings), "hmm-mos"),
            "paper-2024, voxel 0.2 m, range 0.5 to 20 m, online, occupancy_sigma_m 0.3, "
            "min_otsu_score 4");
  EXPECT_EQ(describe_settings(recorded_settings({{"cells", 3}}), "a method of tomorrow"),
            "cells 3");
}

TEST(SettingsJson, NamesFileKeyAndExpectation) {
  EXPECT_THAT(refusal(R"({"max_rang_m": 50})"),
              HasSubstr("near.json: key 'max_rang_m' is not known"));
  EXPECT_THAT(refusal(R"({"max_rang_m": 50})"), HasSubstr("nearest: max_range_m"));
  EXPECT_EQ(refusal(R"({"max_range_m": true})"),
            "near.json: max_range_m: true is not a number, expected 0.1 to 1000");
  EXPECT_EQ(refusal(R"({"max_range_m": null})"),
            "near.json: max_range_m: null is not a number, expected 0.1 to 1000");
  EXPECT_EQ(refusal(R"({"min_otsu_score": 3.0})"),
            "near.json: min_otsu_score: 3.0 is not a whole number, expected 0 to 1000000");
  EXPECT_EQ(refusal(R"({"delay_scans": 4294967298})"),
            "near.json: delay_scans: 4294967298 is out of range, expected 0 to 1000");
  EXPECT_EQ(refusal(R"({"max_range_m": 1e400})").substr(0, 10), "near.json:");
  EXPECT_THAT(refusal("nonsense"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(refusal("\xff\xfe"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(refusal("{\"\xff\": 1}"), HasSubstr("expected a JSON object"));
}

double value_of(std::string_view preset, std::string_view setting) {
  return settings_of(preset_named(preset), *find_method("hmm-mos")).number(setting);
}

TEST(Presets, HaveThePapersSettingsAndAKnownProtocol) {
  for (const Preset& preset : presets()) {
    std::set<std::string_view> taken;
    for (const MethodKind& method : methods()) {
      EXPECT_NO_THROW(method.check(settings_of(preset, method))) << preset.name << method.name;
      for (const Setting& setting : method.defaults.all()) taken.insert(setting.name);
    }
    for (const PresetValue& value : preset.values) EXPECT_TRUE(taken.contains(value.setting));
    const Preset of_kind = preset_for(preset, preset.kind.value_or(DatasetKind::kSipailou));
    EXPECT_NE(find_protocol(of_kind.protocol), nullptr) << preset.name;
    EXPECT_EQ(&preset_named(preset.name), &preset);
  }
  EXPECT_EQ(value_of("doals-20m", "max_range_m"), 20.0);
  EXPECT_EQ(value_of("doals-120m", "max_range_m"), 120.0);
  const Settings dynablox = settings_of(preset_named("doals-20m"), *find_method("dynablox"));
  EXPECT_EQ(dynablox.whole("range_image_columns"), 2048);
  EXPECT_NEAR(dynablox.number("field_of_view_up_deg"), 16.61, 0.01);
  EXPECT_EQ(value_of("sipailou", "min_range_m"), 3.0);
  EXPECT_EQ(value_of("helimos", "voxel_size_m"), 0.25);
  EXPECT_EQ(value_of("helimos-delayed", "delay_scans"), 10);
  const Preset thin = preset_for(preset_named("mid-360"), DatasetKind::kRecording);
  for (const char* method : {"hmm-mos", "hmm-mos-plus"}) {
    const Settings settings = settings_of(thin, *find_method(method));
    EXPECT_EQ(settings.number("voxel_size_m"), 0.15) << method;
    EXPECT_EQ(settings.number("max_range_m"), 50.0) << method;
  }
  EXPECT_EQ(default_preset(DatasetKind::kHelimos).name, "helimos");
  EXPECT_EQ(default_preset(DatasetKind::kDoals).name, "doals-20m");
}

TEST(Presets, OfEachDataSetIsOneOfItsOwnWithItsProtocol) {
  for (const Layout* layout : layouts()) {
    const Preset& usual = default_preset(layout->kind());
    EXPECT_EQ(usual.kind, layout->kind()) << layout->name;
    EXPECT_EQ(usual.name, layout->usual.preset);
    EXPECT_EQ(usual.protocol, layout->usual.protocol);
    EXPECT_NE(find_protocol(layout->usual.protocol), nullptr) << layout->name;
  }
}

TEST(Presets, BestIsPlusWithItsDefaultsAndWhatEachDataSetNeeds) {
  const Preset& best = preset_named("best");
  EXPECT_FALSE(best.kind);
  EXPECT_EQ(best.method, "hmm-mos-plus");
  const MethodKind& plus = *find_method(best.method);
  EXPECT_EQ(to_json(settings_of(best, plus)), to_json(plus.defaults));
  const Preset helimos = preset_for(best, DatasetKind::kHelimos);
  EXPECT_EQ(helimos.name, "best");
  EXPECT_EQ(helimos.method, "hmm-mos-plus");
  EXPECT_EQ(helimos.protocol, "helimos-all");
  EXPECT_EQ(to_json(settings_of(helimos, plus)),
            to_json(settings_of(preset_named("helimos"), plus)));
  EXPECT_EQ(preset_for(preset_named("doals-120m"), DatasetKind::kHelimos).name, "doals-120m");
}

TEST(Presets, NameTheMethodThatTheyAreOf) {
  EXPECT_EQ(method_of({}, {}).name, "hmm-mos");
  EXPECT_EQ(method_of({}, "helimos").name, "hmm-mos");
  EXPECT_EQ(method_of("dynablox", "helimos").name, "dynablox");
  EXPECT_EQ(method_of({}, "best").name, "hmm-mos-plus");
  EXPECT_EQ(method_of("hmm-mos-plus", "best").name, "hmm-mos-plus");
  EXPECT_THAT(message_of<UsageError>([] { method_of("dynablox", "best"); }),
              "--preset best: is of method hmm-mos-plus, expected no --method or this one");
}

// The published rows of these two data sets are of the authors' later program only.
TEST(Presets, OfMoeAndMdetectorAreThoseOfThePublishedRows) {
  for (const char* name : {"moe", "mdetector"}) {
    const Settings settings = settings_of(preset_named(name), methods().front());
    EXPECT_EQ(settings.choice("variant"), "release-2025") << name;
    EXPECT_EQ(std::get<int>(settings.find("local_window_scans")->value), 5);
  }
  const auto variant_of = [](const char* preset) {
    return std::string(settings_of(preset_named(preset), methods().front()).choice("variant"));
  };
  EXPECT_EQ(variant_of("apollo"), "paper-2024");
}

}  // namespace
}  // namespace mosbench
