#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Simulates one scan set per layout; short, as only the table is looked at.
class Tables : public testing::Test {
 protected:
  void simulate(const std::string& layout, const std::string& scene, const std::string& scans = "6",
                const std::string& seed = "1", const std::string& folder = "") const {
    const cli::Answer answer =
        cli::run({"simulate", "--layout", layout, "--scene", scene, "--scans", scans, "--seed",
                  seed, "--out", (folder_ / (folder.empty() ? layout : folder)).string()});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  /// IoU of every labelled scan below a folder of results.
  static std::vector<double> scan_ious(const fs::path& results) {
    std::vector<double> ious;
    for (const auto& entry : fs::recursive_directory_iterator(results)) {
      if (entry.path().filename() != "result.json") continue;
      const auto json = nlohmann::json::parse(read_file(entry.path()));
      for (const auto& scan : json.at("scans")) {
        if (!scan.contains("tp")) continue;
        const double tp = scan.at("tp"), fp = scan.at("fp"), fn = scan.at("fn");
        ious.push_back(tp / (tp + fp + fn));
      }
    }
    return ious;
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

  const cli::Answer other =
      cli::run({"table", "III", (folder_ / "out-sipailou").string(), "--format", "csv"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("left out of table III"));
  EXPECT_THAT(other.err, HasSubstr("06/result.json is of data set sipailou, not helimos"));

  const cli::Answer elsewhere =
      cli::run({"table", "apollo", (folder_ / "out-sipailou").string(), "--format", "latex"});
  EXPECT_THAT(elsewhere.err, HasSubstr("left out of table apollo"));
  const cli::Answer latex =
      cli::run({"table", "II", (folder_ / "out-sipailou").string(), "--format", "latex"});
  EXPECT_THAT(latex.out, HasSubstr("% measured on SIMULATED data"));

  fs::remove_all(folder_ / "out-helimos/helimos/Ouster");
  const cli::Answer part =
      cli::run({"table", "III", (folder_ / "out-helimos").string(), "--format", "markdown"});
  ASSERT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.out, HasSubstr("needs Ouster of HeLiMOS"));
  EXPECT_THAT(part.out, HasSubstr("sequence Ouster is missing"));
}

/// Two recordings of one place, named as published: its column is the mean over the scans of both,
/// at either range, and the other places are named as missing.
TEST_F(Tables, OneIsFilledFromASimulatedDoals) {
  simulate("doals", "mall", "12");
  simulate("doals", "mall", "12", "2", "second");
  fs::rename(folder_ / "doals/mall", folder_ / "doals/station");
  fs::rename(folder_ / "second/mall/sequence_1", folder_ / "doals/station/sequence_2");
  const cli::Answer answer = reproduce("doals", "json");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto table = nlohmann::json::parse(answer.out);
  expect_nothing_compared(table);
  EXPECT_EQ(table.at("columns"), (nlohmann::json{"ST", "SV", "HG", "ND"}));
  std::size_t filled = 0;
  for (const auto& row : table.at("rows")) {
    const auto& station = row.at("cells").at(0);
    if (station.at("measured").is_null()) continue;
    ++filled;
    EXPECT_EQ(row.at("method"), "HMM-MOS");
    EXPECT_THAT(row.at("protocol").get<std::string>(), HasSubstr("doals-hmm"));
    const bool near =
        row.at("setting").get<std::string>().find("range 0.5 to 20 m") != std::string::npos;
    const std::vector<double> ious =
        scan_ious(folder_ / "out-doals" / (near ? "doals-20m" : "doals-120m"));
    ASSERT_EQ(ious.size(), 12U) << "six labelled scans in each recording";
    const double mean = std::accumulate(ious.begin(), ious.end(), 0.0) / 12.0;
    EXPECT_GT(mean, 0.0) << "the method found nothing";
    EXPECT_NEAR(station.at("measured").get<double>(), mean, 1e-12);
    EXPECT_EQ(station.at("sequences"),
              (nlohmann::json{"station/sequence_1 (simulated, scene mall, seed 1)",
                              "station/sequence_2 (simulated, scene mall, seed 1)"}));
    for (std::size_t c = 1; c < 4; ++c) {
      EXPECT_TRUE(row.at("cells").at(c).at("measured").is_null());
      EXPECT_THAT(row.at("cells").at(c).at("reasons").at(0).get<std::string>(),
                  HasSubstr("of DOALS"));
    }
  }
  EXPECT_EQ(filled, 2U);
  const cli::Answer text = cli::run({"table", "i", (folder_ / "out-doals/doals-20m").string()});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("doals-20m: ST is station/sequence_1 (simulated, scene mall"));
}

TEST_F(Tables, AreNotReproducedFromAnotherDataSet) {
  simulate("semantickitti", "room");
  simulate("helimos", "room");
  simulate("doals", "mall");
  struct Case {
    const char *name, *folder, *found, *expected;
  };
  for (const Case& wrong :
       {Case{"sipailou", "semantickitti", "data set semantickitti with 08", "06, 00, 07"},
        Case{"sipailou", "helimos", "data set helimos with", "06, 00, 07"},
        Case{"helimos", "semantickitti", "semantickitti", "HeLiMOS"},
        Case{"doals", "doals", "doals with mall/sequence_1", "station/sequence_1"}}) {
    const cli::Answer answer =
        cli::run({"reproduce", wrong.name, "--data", (folder_ / wrong.folder).string(), "--out",
                  (folder_ / "out").string()});
    EXPECT_EQ(answer.exit_code, 3) << wrong.name << answer.out;
    EXPECT_THAT(answer.err, HasSubstr(wrong.found));
    EXPECT_THAT(answer.err, HasSubstr(wrong.expected));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << "nothing was run";
  }
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
