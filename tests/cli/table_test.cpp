#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Simulates one scan set per layout; short, as only the table is looked at.
class Tables : public testing::Test {
 protected:
  void simulate(const std::string& layout, const std::string& scene) const {
    const cli::Answer answer =
        cli::run({"simulate", "--layout", layout, "--scene", scene, "--scans", "6", "--seed", "1",
                  "--out", (folder_ / layout).string()});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  cli::Answer reproduce(const std::string& layout, const std::string& format) const {
    return cli::run({"reproduce", layout, "--data", (folder_ / layout).string(), "--out",
                     (folder_ / ("out-" + layout)).string(), "--format", format});
  }
  /// Every measured cell is not comparable because its data is simulated.
  void expect_nothing_compared(const nlohmann::json& table) const {
    EXPECT_TRUE(table.at("simulated").get<bool>());
    std::size_t measured = 0;
    for (const auto& row : table.at("rows")) {
      for (const auto& cell : row.at("cells")) {
        if (cell.at("measured").is_null()) continue;
        ++measured;
        EXPECT_EQ(cell.at("verdict"), "not comparable");
        EXPECT_EQ(cell.at("reasons").at(0), "simulated data");
      }
    }
    EXPECT_GT(measured, 0U);
  }

  TempFolder folder_;
};

TEST_F(Tables, FromSimulatedDataCompareNothingAndNameWhatIsMissing) {
  for (const auto& [layout, scene] :
       {std::pair{"sipailou", "room"}, std::pair{"helimos", "room"}}) {
    simulate(layout, scene);
    const cli::Answer answer = reproduce(layout, "json");
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    expect_nothing_compared(nlohmann::json::parse(answer.out));
  }
  const cli::Answer again = reproduce("helimos", "markdown");
  EXPECT_THAT(again.err, HasSubstr("finished by an earlier run, kept"));
  EXPECT_THAT(again.out, HasSubstr("SIMULATED"));

  fs::remove_all(folder_ / "out-helimos/helimos/Ouster");
  const cli::Answer part =
      cli::run({"table", "III", (folder_ / "out-helimos").string(), "--format", "markdown"});
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.out, HasSubstr("needs Ouster of HeLiMOS"));
  EXPECT_THAT(part.out, HasSubstr("sequence Ouster is missing"));
}

TEST_F(Tables, ArePrintedWithoutResultsInEveryFormat) {
  for (const char* table : {"I", "II", "III", "apollo", "moe", "mdetector"}) {
    for (const char* format : {"markdown", "csv", "latex", "json"}) {
      const cli::Answer answer = cli::run({"table", table, "--format", format});
      ASSERT_EQ(answer.exit_code, 0) << answer.err;
      EXPECT_THAT(answer.out, HasSubstr("HMM-MOS"));
    }
  }
  EXPECT_EQ(cli::run({"table", "IV"}).exit_code, 2);
  EXPECT_EQ(cli::run({"table", "I", "--format", "word"}).exit_code, 2);
  EXPECT_EQ(cli::run({"table", "I", (folder_ / "nowhere").string()}).exit_code, 3);
  EXPECT_EQ(cli::run({"reproduce", "kitti", "--data", folder_.path().string()}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
