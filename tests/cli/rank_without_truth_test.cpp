#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/disk/files.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class RankWithoutTruth : public testing::Test {
 protected:
  void SetUp() override {
    cli::write_small_sequence(folder_ / "room", 40);
    std::filesystem::remove_all(folder_ / "room/labels");
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  void run(const std::string& name, const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {"run", in("room"), "--out", in(name)};
    words.insert(words.end(), flags.begin(), flags.end());
    const cli::Answer answer = cli::run(words);
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }

  TempFolder folder_;
};

TEST_F(RankWithoutTruth, OrdersMethodsByWhatOtherScansSee) {
  // The box is 3 m away.
  run("good", {"--method", "hmm-mos-plus", "--set", "min_range_m=0.5"});
  run("blind", {"--method", "hmm-mos", "--set", "max_range_m=2,min_range_m=0.5"});
  const std::string refused = cli::run({"rank", in("blind"), in("good")}).err;
  EXPECT_THAT(refused, HasSubstr("has no scan with truth, expected a run that was scored, or "
                                 "--no-truth"));
  const cli::Answer answer = cli::run({"rank", in("blind"), in("good"), "--no-truth"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("an order, not a score"));
  EXPECT_LT(answer.out.find("1: " + in("good")), answer.out.find("2: " + in("blind")));
  const nlohmann::json rows =
      nlohmann::json::parse(cli::run({"rank", in("blind"), in("good"), "--no-truth", "--json"}).out)
          .at("sheets")
          .at(0)
          .at("rows");
  EXPECT_GT(rows.at(0).at("agreement"), 0.2);
  EXPECT_EQ(rows.at(1).at("agreement"), 0);
}

TEST_F(RankWithoutTruth, RefusesOtherScansLostLabelsAndJobs) {
  run("one", {});
  std::filesystem::remove_all(folder_ / "room");
  cli::write_small_sequence(folder_ / "room", 30, 3);
  run("other", {});
  const cli::Answer unlike = cli::run({"rank", in("one"), in("other"), "--no-truth"});
  EXPECT_EQ(unlike.exit_code, 3);
  EXPECT_THAT(unlike.err, HasSubstr("expected runs on the same scans with the same poses"));
  std::filesystem::remove_all(folder_ / "other/room/labels");
  const cli::Answer lost = cli::run({"rank", in("other"), "--no-truth"});
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.err, HasSubstr("has no labels beside it"));
  write_file_atomic(folder_ / "job.yaml",
                    "name: a\ndata: [{name: b, path: room}]\nmethods: [yoon]\n");
  EXPECT_EQ(cli::run({"rank", in("job.yaml"), "--no-truth"}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
