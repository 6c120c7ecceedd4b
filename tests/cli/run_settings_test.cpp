#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>

#include "datasets/text/errors.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/job.hpp"
#include "eval/result/settings_json.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

/// Legal values other than that of the setting.
std::vector<SettingValue> other_values(const Setting& setting) {
  std::vector<SettingValue> values;
  if (const auto* whole = std::get_if<int>(&setting.value)) {
    for (const int value : {*whole + 1, *whole - 1, *whole + 2, *whole + 4}) {
      if (value >= setting.lowest && value <= setting.highest) values.emplace_back(value);
    }
  } else if (const auto* number = std::get_if<double>(&setting.value)) {
    for (const double value : {1.25 * *number, 0.75 * *number, setting.highest, setting.lowest}) {
      if (value == *number || value < setting.lowest || value > setting.highest) continue;
      values.emplace_back(value);
    }
  } else {
    for (const std::string_view choice : setting.choices) {
      if (choice != std::get<std::string>(setting.value)) values.emplace_back(std::string(choice));
    }
  }
  return values;
}

std::string assignment_of(const Setting& setting, const SettingValue& value) {
  return std::string(setting.name) + "=" + to_string(value);
}

class RunSettings : public testing::Test {
 protected:
  RunSettings() { cli::write_small_sequence(folder_ / "room", 2); }

  nlohmann::ordered_json result_of(const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--overwrite", "--out",
                                      (folder_ / "out").string()};
    words.insert(words.end(), flags.begin(), flags.end());
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return nlohmann::ordered_json::parse(read_file(folder_ / "out/room/result.json"));
  }

  /// Returns what results of a plan say about the method; nothing where the value contradicts the
  /// other settings.
  std::optional<nlohmann::ordered_json> planned(const MethodKind& method, const Setting& setting,
                                                const SettingValue& value) const {
    JobWords options;
    options.input = folder_ / "room";
    options.method = std::string(method.name);
    options.assignments = {assignment_of(setting, value)};
    // More votes than one need more references than the default.
    if (setting.name == "min_votes") options.assignments.push_back("references=3");
    try {
      return to_json(
          *plan_run(job_of(options), {.out = folder_ / "planned"}).sequences.at(0).asked.settings);
    } catch (const UsageError&) {
      return std::nullopt;
    }
  }

  TempFolder folder_;
};

TEST_F(RunSettings, OfEveryMethodStandInItsResult) {
  for (const MethodKind& method : methods()) {
    const auto config = result_of({"--method", std::string(method.name)}).at("settings");
    EXPECT_EQ(config.size(), method.defaults.all().size()) << method.name;
    for (const Setting& setting : method.defaults.all()) {
      EXPECT_TRUE(config.contains(std::string(setting.name))) << method.name << setting.name;
    }
  }
}

TEST_F(RunSettings, StandInTheResultWithTheValueThatWasGiven) {
  const auto json = result_of({"--set", "voxel_size_m=0.3,max_range_m=17,delay_scans=1"});
  EXPECT_EQ(json.at("settings").at("voxel_size_m"), 0.3);
  EXPECT_EQ(json.at("settings").at("max_range_m"), 17.0);
  EXPECT_EQ(json.at("settings").at("delay_scans"), 1);
  for (const MethodKind& method : methods()) {
    for (const Setting& setting : method.defaults.all()) {
      std::size_t accepted = 0;
      for (const SettingValue& value : other_values(setting)) {
        const auto config = planned(method, setting, value);
        if (!config) continue;
        ++accepted;
        Settings expected = method.defaults;
        apply_setting_assignment(assignment_of(setting, value), expected);
        EXPECT_EQ(config->at(std::string(setting.name)),
                  to_json(expected).at(std::string(setting.name)))
            << method.name << ": " << setting.name;
      }
      EXPECT_GT(accepted, 0U) << method.name << ": " << setting.name;
    }
  }
}

TEST_F(RunSettings, OfAPresetThatAMethodLacksAreNamed) {
  JobWords options;
  options.input = folder_ / "room";
  options.preset = "helimos-delayed";
  options.method = "yoon";
  EXPECT_THAT(plan_run(job_of(options), {}).notes,
              testing::Contains("preset helimos-delayed: method yoon has no voxel_size_m, "
                                "delay_scans, it runs without"));
  options.method = "hmm-mos";
  EXPECT_THAT(plan_run(job_of(options), {}).notes,
              testing::Not(testing::Contains(testing::HasSubstr("runs without"))));
}

TEST_F(RunSettings, OfPresetBestAreThoseOfPlusAndOfTheDataSet) {
  const auto best = result_of({"--preset", "best"});
  EXPECT_EQ(best.at("preset"), "best");
  EXPECT_EQ(best.at("method").at("kind"), "hmm-mos-plus");
  const auto plus = result_of({"--method", "hmm-mos-plus"});
  EXPECT_EQ(best.at("settings"), plus.at("settings"));
  EXPECT_EQ(best.at("protocol"), plus.at("protocol"));
  JobWords options;
  options.input = folder_ / "room";
  options.preset = "best";
  options.method = "yoon";
  EXPECT_THROW(job_of(options), UsageError);
}

TEST_F(RunSettings, OfOdometryStandInTheResultToo) {
  for (const OdometryKind& kind : odometries()) {
    const auto json = result_of({"--odometry", std::string(kind.name)});
    const std::string statement = json.at("reading").at("pose_odometry");
    for (const Setting& setting : kind.defaults.all()) {
      const std::string words =
          " " + std::string(setting.name) + "=" + to_string(setting.value) + " ";
      EXPECT_NE((" " + statement + " ").find(words), std::string::npos) << statement << words;
    }
  }
}

TEST_F(RunSettings, OfScoringAndReadingStandInTheResultToo) {
  const auto json = result_of({"--protocol", "doals-hmm", "--range", "1,9", "--preset", "doals-20m",
                               "--pose-direction", "sensor-from-map"});
  EXPECT_EQ(json.at("protocol").at("name"), "doals-hmm");
  EXPECT_EQ(json.at("protocol").at("min_range_m"), 1.0);
  EXPECT_EQ(json.at("protocol").at("max_range_m"), 9.0);
  EXPECT_EQ(json.at("preset"), "doals-20m");
  EXPECT_EQ(json.at("reading").at("pose_direction"), "sensor_from_map, inverted");
}

TEST_F(RunSettings, OfMovingEverRememberWhatMovedAndSetWins) {
  const auto config = [&](const std::vector<std::string>& more) {
    std::vector<std::string> flags = {"--method", "hmm-mos-plus"};
    flags.insert(flags.end(), more.begin(), more.end());
    return result_of(flags).at("settings");
  };
  const auto now = config({}), ever = config({"--moving", "ever"});
  EXPECT_EQ(config({"--moving", "now"}), now);
  for (const char* age : {"seed_age_s", "object_age_s", "fresh_age_s"}) {
    EXPECT_LE(now.at(age), 2.0) << age;
    EXPECT_EQ(ever.at(age), 10.0) << age;
    EXPECT_EQ(config({"--moving", "ever:2.5"}).at(age), 2.5) << age;
  }
  EXPECT_EQ(ever.at("max_aged_share"), 1.0);
  EXPECT_EQ(config({"--moving", "ever", "--set", "fresh_age_s=3"}).at("fresh_age_s"), 3.0);
}

TEST_F(RunSettings, OfMovingEverAreRefusedWhereTheyMeanNothing) {
  const auto refusal = [&](const std::string& moving, const std::string& method) {
    const cli::Answer answer = cli::run({"run", folder_ / "room", "--method", method, "--moving",
                                         moving, "--out", folder_ / "out"});
    EXPECT_EQ(answer.exit_code, 2) << moving;
    return answer.err;
  };
  EXPECT_THAT(refusal("ever", "hmm-mos"),
              testing::HasSubstr("method hmm-mos does not remember what moved"));
  EXPECT_THAT(refusal("always", "hmm-mos-plus"),
              testing::HasSubstr("moving: 'always' is not known, expected now, ever"));
  for (const char* wrong : {"ever:", "ever:x", "ever:nan"}) {
    EXPECT_THAT(refusal(wrong, "hmm-mos-plus"),
                testing::HasSubstr(std::string("moving: '") + wrong + "' is not known"));
  }
  for (const char* wrong : {"ever:11", "ever:-1"}) {
    EXPECT_THAT(refusal(wrong, "hmm-mos-plus"), testing::HasSubstr("seed_age_s")) << wrong;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

}  // namespace
}  // namespace mosbench
