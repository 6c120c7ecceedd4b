#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kDropAndNoise = "dropout_probability=0.5,pose_noise_m=0.05,seed=3";

class PerturbedRuns : public testing::Test {
 protected:
  void SetUp() override { cli::write_small_sequence(folder_ / "s", 8); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ordered_json run_to(const std::string& out, std::vector<std::string> flags) const {
    std::vector<std::string> words = {"run", path("s"), "--out", path(out)};
    words.insert(words.end(), flags.begin(), flags.end());
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return cli::timeless_result(folder_ / out / "s");
  }
  TempFolder folder_;
};

TEST_F(PerturbedRuns, RecordWhatWasDisturbed) {
  const ordered_json plain = run_to("plain", {});
  const ordered_json disturbed = run_to("disturbed", {"--perturb", kDropAndNoise});
  EXPECT_EQ(disturbed.at("reading").at("perturb"), kDropAndNoise);
  EXPECT_FALSE(plain.at("reading").contains("perturb"));
  EXPECT_NE(disturbed.at("provenance").at("fingerprint"), plain.at("provenance").at("fingerprint"));
  EXPECT_NE(disturbed.at("provenance").at("fingerprint_without_poses"),
            plain.at("provenance").at("fingerprint_without_poses"));
  const ordered_json threads = run_to("threads", {"--perturb", kDropAndNoise, "--threads", "3"});
  EXPECT_EQ(threads, disturbed);
  // Other disturbances are other results.
  const cli::Answer other = cli::run(
      {"run", path("s"), "--out", path("disturbed"), "--perturb", "dropout_probability=0.4"});
  EXPECT_EQ(other.exit_code, 2);
}

TEST_F(PerturbedRuns, AreOpenedAgainAsTheyWere) {
  run_to("disturbed", {"--perturb", "range_bias_m=0.5,every_nth_scan=2"});
  const cli::Answer drawn =
      cli::run({"render", path("disturbed/s"), "--scan", "3", "--out", path("scan.png")});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(
      cli::run({"render", path("disturbed/s"), "--scan", "4", "--out", path("no.png")}).exit_code,
      2);
}

TEST_F(PerturbedRuns, AreTheSameAsOfDataThatWereConvertedWithThem) {
  const std::string text = "range_noise_m=0.02,dropout_probability=0.2,scan_loss_probability=0.3";
  const cli::Answer converted = cli::run({"convert", path("s"), "--layout", "semantickitti",
                                          "--out", path("converted"), "--perturb", text});
  ASSERT_EQ(converted.exit_code, 0) << converted.err;
  const ordered_json disturbed = run_to("disturbed", {"--perturb", text});
  const cli::Answer run = cli::run({"run", path("converted"), "--out", path("again")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ordered_json again = cli::timeless_result(folder_ / "again/s");
  EXPECT_EQ(again.at("summary"), disturbed.at("summary"));
  EXPECT_EQ(again.at("provenance").at("fingerprint_without_poses"),
            disturbed.at("provenance").at("fingerprint_without_poses"));
  const cli::Answer ranked = cli::run({"rank", path("disturbed"), path("again"), "--json"});
  ASSERT_EQ(ranked.exit_code, 0) << ranked.err;
  EXPECT_THAT(ranked.out, Not(HasSubstr("\"perturb\": \"none\"")));
}

TEST_F(PerturbedRuns, AreScoredWithAWordWhereTheTruthIsOfOtherScans) {
  run_to("disturbed", {"--perturb", "dropout_probability=0.5,seed=1"});
  const auto score = [&](const char* perturb) {
    const cli::Answer answer =
        cli::run({"score", path("s"), "--predictions", path("disturbed"), "--perturb", perturb});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return answer.out + answer.err;
  };
  EXPECT_THAT(
      score("range_bias_m=0,seed=1"),
      HasSubstr("the scans that were labelled are disturbed by dropout_probability=0.5,seed=1"));
  EXPECT_THAT(score("dropout_probability=0.5,seed=1"),
              testing::Not(HasSubstr("that were labelled")));
}

TEST_F(PerturbedRuns, RefuseWhatDoesNotFit) {
  const auto error = [&](std::vector<std::string> words) {
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 2) << answer.err;
    return answer.err;
  };
  EXPECT_THAT(error({"run", path("s"), "--perturb", "rain=3"}), HasSubstr("rain_mm_per_h"));
  EXPECT_THAT(error({"profile", path("s"), "--perturb", "stamp_jitter_s=1"}),
              HasSubstr("have no stamps"));
  EXPECT_THAT(error({"odometry", path("s"), "-o", path("p.txt"), "--perturb", "pose_noise_m=1"}),
              HasSubstr("mosbench convert --perturb first"));
  EXPECT_THAT(error({"simulate", "--layout", "doals", "--scene", "room", "--scans", "2", "--seed",
                     "1", "--out", path("sim"), "--perturb", "beams"}),
              HasSubstr("--perturb"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
}

TEST_F(PerturbedRuns, NameWhatIsOutOfReachAndOneExpectation) {
  const cli::Answer answer = cli::run(
      {"run", path("s"), "--out", path("far"), "--perturb", "range_bias_m=1e6,range_noise_m=1e6"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("000000.bin: point 0: its voxel index overflows, expected a "
                                    "point within 524288 voxels of the sensor\n"));
}

TEST(PerturbedSimulations, SayWhatDisturbedThem) {
  const TempFolder folder;
  const auto simulate = [&](const char* out, const char* text) {
    std::vector<std::string> words = {"simulate", "--layout", "doals",  "--scene", "room",
                                      "--scans",  "6",        "--seed", "1",       "--out"};
    words.push_back((folder / out).string());
    if (text != nullptr) words.insert(words.end(), {"--perturb", text});
    return cli::run(words);
  };
  const char* text = "beams=16,range_noise_m=0.1";
  ASSERT_EQ(simulate("plain", nullptr).exit_code, 0);
  ASSERT_EQ(simulate("disturbed", text).exit_code, 0);
  const auto marker = ordered_json::parse(read_file(folder / "disturbed/simulated.json"));
  EXPECT_EQ(marker.at("perturb"), "beams=16,range_noise_m=0.1,beams_of=64,seed=1");
  EXPECT_EQ(simulate("disturbed", "beams=16").exit_code, 2);
  // The scans are those that reading the undisturbed ones gives.
  ASSERT_EQ(cli::run({"convert", (folder / "plain").string(), "--layout", "doals", "--out",
                      (folder / "converted").string(), "--perturb", text})
                .exit_code,
            0);
  const std::string scan = "room/sequence_1/velodyne/000003.bin";
  const std::string bytes = read_file(folder.path() / "disturbed" / scan);
  EXPECT_EQ(bytes, read_file(folder.path() / "converted" / scan));
  EXPECT_NE(bytes, read_file(folder.path() / "plain" / scan));
  // And so is what they say of themselves, also when they are disturbed once more.
  const auto converted = ordered_json::parse(read_file(folder / "converted/simulated.json"));
  EXPECT_EQ(converted.at("perturb"), marker.at("perturb"));
  ASSERT_EQ(cli::run({"convert", (folder / "converted").string(), "--layout", "doals", "--out",
                      (folder / "twice").string(), "--perturb", "range_bias_m=1"})
                .exit_code,
            0);
  const auto twice = ordered_json::parse(read_file(folder / "twice/simulated.json"));
  EXPECT_EQ(twice.at("perturb"),
            marker.at("perturb").get<std::string>() + ", then range_bias_m=1,seed=1");
}

}  // namespace
}  // namespace mosbench
