#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "datasets/disk/files.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"
#include "tests/cli/program.hpp"

// tests/golden/old_results/README.md says how the files were made.

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

fs::path old_results() { return fs::path(MOSBENCH_SOURCE_DIR) / "tests/golden/old_results"; }

Result old_result(const std::string& name) {
  return read_result(old_results() / name / (name == "split" ? "Avia" : "08") / "result.json");
}

TEST(OldResults, HaveTheNumbersThatTheirVersionGaveThem) {
  const std::vector<fs::path> files = find_result_files(old_results());
  ASSERT_EQ(files.size(), 8U);
  for (const fs::path& file : files) {
    const auto written = ordered_json::parse(read_file(file));
    const Result result = read_result(file);
    const SequenceCounts counts = counts_of(result);
    ordered_json summary = to_json(summarize(*result.protocol, counts));
    summary.erase("false_positives_per_scan");  // younger than these files
    EXPECT_EQ(summary, written.at("summary")) << file;
    EXPECT_EQ(result.scans.size(), written.at("scans").size()) << file;
    if (!written.contains("timing")) continue;
    EXPECT_EQ(method_ms_per_scan(result), written.at("timing").at("method_ms_per_scan")) << file;
    EXPECT_EQ(result.timing->threads, 1U) << file;
    EXPECT_EQ(result.places->dataset_root->string(), written.at("timing").at("dataset_root"))
        << file;
  }
}

TEST(OldResults, AreTheSameAfterTheyWereWrittenInThePresentFormat) {
  const TempFolder folder;
  for (const fs::path& file : find_result_files(old_results())) {
    const Result result = read_result(file);
    const std::string text = format_result(result);
    EXPECT_EQ(ordered_json::parse(text).at("format"), kResultFormat);
    write_file_atomic(folder / "result.json", text);
    EXPECT_EQ(format_result(read_result(folder / "result.json")), text) << file;
  }
}

TEST(OldResults, KeepSettingsReadingAndProvenance) {
  const Result run = old_result("run");
  EXPECT_EQ(run.kind, "hmm-mos-plus");
  EXPECT_EQ(run.settings->number("voxel_size_m", 0.0), 0.25);
  EXPECT_THAT(run.setting, HasSubstr("voxel 0.25 m"));
  EXPECT_EQ(run.from.version, "0.1.0+877dea5");
  EXPECT_EQ(run.from.machine->system, "Linux x86_64");
  EXPECT_EQ(run.from.simulated->scene, "room");
  EXPECT_EQ(run.from.simulated->seed, 3U);
  EXPECT_EQ(run.from.fingerprint.size(), 32U);
  EXPECT_THAT(run.places->sequences_of_run, ElementsAre("08"));
  EXPECT_EQ(disturbance_of(old_result("perturb")), "range_noise_m=0.02,seed=2");
  EXPECT_TRUE(old_result("perturb").places->reading.perturb);

  const Result odometry = old_result("odometry");
  ASSERT_TRUE(odometry.from.odometry);
  EXPECT_EQ(odometry.from.odometry->name, "odometry kiss");
  EXPECT_EQ(odometry.from.odometry->settings.number("max_iterations", 0.0), 500.0);
  EXPECT_EQ(odometry.from.odometry->settings.word("deskew"), "velocity");
  EXPECT_THAT(odometry.from.odometry->map, HasSubstr("without what hmm-mos-plus finds moving"));
  EXPECT_TRUE(odometry.places->reading.is_by_odometry());
  EXPECT_TRUE(odometry.doubtful_poses);

  const Result first = old_result("format_1");
  EXPECT_EQ(first.method, "HMM-MOS");
  EXPECT_EQ(first.settings->word("variant"), "paper-2024");
  EXPECT_EQ(first.settings->number("distance_field_scans", 0.0), 2.0);
  EXPECT_FALSE(first.scans.front().judged);
  EXPECT_FALSE(first.timing);

  const Result scored = old_result("score");
  EXPECT_EQ(scored.setting, "as found");
  EXPECT_EQ(scored.predictions->format, "label");
  EXPECT_EQ(scored.places->predictions->path, "/data/underwood");
  EXPECT_THAT(old_result("split").splits.at("test"), ElementsAre("000003"));
  EXPECT_EQ(old_result("exec").settings->number("timeout_s", 0.0), 60.0);
}

/// A run of now over the same data, among those of then. Labels of underwood do not change.
class OldBesideNew : public testing::Test {
 protected:
  OldBesideNew() {
    done({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "14", "--seed",
          "3", "--out", folder_ / "sim"});
    done({"run", folder_ / "sim", "--method", "underwood", "--out", folder_ / "new"});
  }
  cli::Answer done(const std::vector<std::string>& arguments) {
    cli::Answer answer = cli::run(arguments);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return answer;
  }

  TempFolder folder_;
};

TEST_F(OldBesideNew, IsRankedComparedAndGated) {
  const std::string run = old_results() / "run", underwood = old_results() / "underwood";
  const auto ranked =
      ordered_json::parse(done({"rank", folder_ / "new", run, underwood, "--as", "json"}).out);
  ASSERT_EQ(ranked.at("rows").size(), 3U);
  EXPECT_EQ(ranked.at("rows").at(1).at("all"), ranked.at("rows").at(2).at("all"));
  EXPECT_EQ(ranked.at("rows").at(0).at("method"), old_result("run").method);
  const auto difference =
      ordered_json::parse(done({"stats", underwood, folder_ / "new", "--as", "json"}).out);
  EXPECT_EQ(difference.at("paired_scans"), 14);
  EXPECT_EQ(difference.at("unlike"), "");
  EXPECT_EQ(difference.at("difference").at("iou").at("value"), 0.0);
  EXPECT_THAT(done({"compare", underwood, folder_ / "new"}).out, HasSubstr("pass"));
}

}  // namespace
}  // namespace mosbench
