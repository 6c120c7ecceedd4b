#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class ScoreCurves : public testing::Test {
 protected:
  ScoreCurves() { cli::write_small_sequence(folder_ / "room", 10); }

  cli::Answer run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", folder_ / "room", "--out", folder_ / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(ScoreCurves, OfARunWithScoresHasItsLabelsAndAPicture) {
  ASSERT_EQ(run({"--scores"}).exit_code, 0);
  const cli::Answer answer =
      cli::run({"curve", folder_ / "out", "--as", "json", "-o", folder_ / "curve.png"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto json = nlohmann::json::parse(answer.out);
  const auto summary = cli::timeless_result(folder_ / "out/room").at("summary");
  EXPECT_EQ(json.at("labels").at("iou"), summary.at("iou"));
  EXPECT_GT(json.at("average_precision").get<double>(), 0.1);
  EXPECT_GE(json.at("best").at("iou").get<double>(), json.at("curve").at(0).at("iou"));
  EXPECT_EQ(json.at("curve").back().at("recall"), 1.0) << "the lowest score takes every point";
  EXPECT_THAT(read_file(folder_ / "curve.png"), testing::StartsWith("\x89PNG"));
  const cli::Answer text = cli::run({"curve", folder_ / "out"});
  EXPECT_THAT(text.out, HasSubstr("average precision "));
  const cli::Answer csv = cli::run({"curve", folder_ / "out", "--as", "csv"});
  EXPECT_THAT(csv.out,
              testing::StartsWith("threshold,recall,precision,iou,tp,fp,fn,tn,standing\n"));
}

TEST_F(ScoreCurves, IsRefusedWithoutScoresAndSaysWhatToDo) {
  ASSERT_EQ(run().exit_code, 0);
  const cli::Answer answer = cli::run({"curve", folder_ / "out"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("out/room/scores: is not there, expected scores of points: "
                                    "give the same run command again, with --write scores"));
}

TEST_F(ScoreCurves, IsRefusedForLabelsOfOthersAndForSeveralRuns) {
  ASSERT_EQ(run({"--scores"}).exit_code, 0);
  ASSERT_EQ(cli::run({"score", folder_ / "room", "--predictions", folder_ / "out", "--out",
                      folder_ / "scored", "--method", "Mine"})
                .exit_code,
            0);
  const cli::Answer scored = cli::run({"curve", folder_ / "scored"});
  EXPECT_EQ(scored.exit_code, 3);
  EXPECT_THAT(scored.err, HasSubstr("is of mosbench score"));
  const cli::Answer both = cli::run({"curve", folder_.path()});
  EXPECT_EQ(both.exit_code, 3);
  EXPECT_THAT(both.err, HasSubstr("holds 2 runs"));
}

TEST_F(ScoreCurves, SaysWhenAMethodGivesNoMoreThanLabels) {
  ASSERT_EQ(run({"--scores", "--method", "dufomap"}).exit_code, 0);
  const cli::Answer answer = cli::run({"curve", folder_ / "out"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("the scores take 2 values: the method says no more than its "
                                    "labels"));
}

}  // namespace
}  // namespace mosbench
