// What users give in place of predictions, or say wrongly about them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class PredictionMistakes : public testing::Test {
 protected:
  PredictionMistakes() {
    cli::write_small_sequence(folder_ / "room", 6);
    fs::copy(folder_ / "room/labels", folder_ / "mine");
  }
  cli::Answer score(const fs::path& predictions, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"score", (folder_ / "room").string(), "--predictions",
                                      predictions.string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(PredictionMistakes, AMaskThatFitsNoScanIsRefusedWithItsCounts) {
  for (const char* mask : {"4,20", "500,600"}) {
    const cli::Answer answer = score(folder_ / "mine", {"--mask", mask});
    EXPECT_EQ(answer.exit_code, 3) << mask;
    EXPECT_THAT(answer.err, HasSubstr(".label: has 8640 labels, expected one for each of the "));
  }
  // Nothing lies outside: the mask is true, and cuts nothing.
  EXPECT_EQ(score(folder_ / "mine", {"--mask", "0,100"}).exit_code, 0);
}

TEST_F(PredictionMistakes, AMaskForAFormatThatCutsNoRangeIsRefused) {
  std::string rows;
  for (int k = 1; k <= 6; ++k) rows += std::to_string(k) + ",5\n";
  const fs::path file = folder_.write("rows.txt", rows);
  ASSERT_EQ(score(file).exit_code, 0);
  const cli::Answer in_rows = score(file, {"--mask", "0,50"});
  EXPECT_EQ(in_rows.exit_code, 2);
  EXPECT_THAT(in_rows.err, HasSubstr("--mask: is for format label-masked, not for rows"));
  const cli::Answer told = score(folder_ / "mine", {"--mask", "0,50", "--format", "label"});
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.err, HasSubstr("not for label"));
}

TEST_F(PredictionMistakes, TextsThatHoldNoPredictionsArePassedOver) {
  const fs::path readme = folder_.write("root/README.txt", "Made by hand.\n\nFor a test.\n");
  const cli::Answer root = score(folder_ / "root");
  EXPECT_EQ(root.exit_code, 3);
  EXPECT_THAT(root.err, HasSubstr("root: no predictions for sequence room"));
  EXPECT_THAT(root.err, Not(HasSubstr("README")));
  // Beside predictions it does not hide them.
  std::string rows;
  for (int k = 1; k <= 6; ++k) rows += std::to_string(k) + ",5\n";
  folder_.write("table/rows.txt", rows);
  fs::copy(readme, folder_ / "table/README.txt");
  const cli::Answer table = score(folder_ / "table");
  EXPECT_EQ(table.exit_code, 0) << table.err;
  // Whoever names it is told what is wrong with it.
  EXPECT_THAT(score(readme).err, HasSubstr("README.txt:"));
}

TEST_F(PredictionMistakes, AFaultyFileIsReportedOnce) {
  fs::resize_file(folder_ / "mine/000003.label", 100);
  const cli::Answer answer = score(folder_ / "mine", {"--allow-missing"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("000003.label: has 100 bytes"));
  EXPECT_THAT(answer.out, Not(HasSubstr("000003.label: is not there")));
  EXPECT_THAT(answer.out, HasSubstr("INCOMPLETE: 1 scans"));
}

}  // namespace
}  // namespace mosbench
