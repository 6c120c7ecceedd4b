#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/disk/files.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

class Delay : public testing::Test {
 protected:
  Delay() { cli::write_small_sequence(folder_ / "room", 6); }

  cli::Answer run(const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--overwrite", "--out",
                                      (folder_ / "out").string()};
    words.insert(words.end(), flags.begin(), flags.end());
    return cli::run(words);
  }

  /// Returns the settings of a run that ends well.
  nlohmann::ordered_json settings_with(const std::vector<std::string>& flags) const {
    const cli::Answer answer = run(flags);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    const auto result = nlohmann::ordered_json::parse(read_file(folder_ / "out/room/result.json"));
    EXPECT_EQ(result.at("scans").size(), 6U);
    return result.at("settings");
  }

  std::string refusal(const std::string& delay, const std::string& method) const {
    const cli::Answer answer = run({"--method", method, "--set", "delay=" + delay});
    EXPECT_EQ(answer.exit_code, 2) << delay;
    return answer.err;
  }

  TempFolder folder_;
};

TEST_F(Delay, OfAllScansIsAWindowOfTracks) {
  for (const char* method : {"hmm-mos", "hmm-mos-plus"}) {
    const auto all = settings_with({"--method", method, "--set", "delay=all"});
    EXPECT_EQ(all.at("track_window_s"), 60.0) << method;
    EXPECT_EQ(all.at("delay_scans"), 0) << method;
    const auto half = settings_with({"--method", method, "--set", "delay=all:30"});
    EXPECT_EQ(half.at("track_window_s"), 30.0) << method;
  }
}

TEST_F(Delay, OfScansIsTheSettingOfToday) {
  const auto scans = settings_with({"--method", "hmm-mos-plus", "--set", "delay=3"});
  EXPECT_EQ(scans.at("delay_scans"), 3);
  EXPECT_EQ(scans.at("track_window_s"), 0.0);
  EXPECT_EQ(scans, settings_with({"--method", "hmm-mos-plus", "--set", "delay_scans=3"}));
  EXPECT_EQ(settings_with({"--preset", "offline", "--set", "delay=3"}), scans) << "the last counts";
}

TEST_F(Delay, OfPresetOfflineIsThatOfAllScans) {
  const auto all = settings_with({"--method", "hmm-mos-plus", "--set", "delay=all"});
  EXPECT_EQ(settings_with({"--preset", "offline"}), all);
  EXPECT_EQ(settings_with(
                {"--preset", "helimos-delayed", "--method", "hmm-mos-plus", "--set", "delay=all"})
                .at("delay_scans"),
            0);
}

TEST_F(Delay, WritesScoresAndReasonsOfWholeTracks) {
  settings_with({"--preset", "offline", "--scores"});
}

TEST_F(Delay, IsRefusedWhereItMeansNothing) {
  for (const char* wrong : {"some", "all:0", "all:", "all:x", "all:nan", "allx", "2.5", "-1"}) {
    EXPECT_THAT(refusal(wrong, "hmm-mos-plus"), testing::HasSubstr("expected")) << wrong;
  }
  EXPECT_THAT(refusal("some", "hmm-mos-plus"),
              testing::HasSubstr("delay=some: is no delay, expected a number of scans, all"));
  EXPECT_THAT(refusal("all:4000", "hmm-mos-plus"), testing::HasSubstr("expected 0 to 3600"));
  EXPECT_THAT(refusal("all", "underwood"), testing::HasSubstr("does not judge whole tracks"));
  const cli::Answer both = run({"--preset", "offline", "--set", "delay_scans=3"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, testing::HasSubstr("expected delay=3, which judges no whole tracks"));
  const cli::Answer later = run({"--method", "hmm-mos", "--set", "variant=release-2025,delay=all"});
  EXPECT_EQ(later.exit_code, 2);
  EXPECT_THAT(later.err, testing::HasSubstr("in release-2025, which has no delay"));
}

}  // namespace
}  // namespace mosbench
