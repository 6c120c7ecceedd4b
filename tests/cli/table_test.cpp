#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

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
    return cli::run({"run", "table:" + layout, "--data", (folder_ / layout).string(), "--out",
                     (folder_ / ("out-" + layout)).string(), "--as", format});
  }
  /// Every measured cell stands apart from published ones because its data is simulated.
  void expect_nothing_compared(const nlohmann::json& table) const {
    EXPECT_TRUE(table.at("simulated").get<bool>());
    std::size_t measured = 0;
    for (const auto& row : table.at("rows")) {
      for (const auto& cell : row.at("cells")) {
        if (cell.at("measured").is_null()) continue;
        ++measured;
        EXPECT_TRUE(row.at("apart").get<bool>());
        EXPECT_TRUE(cell.at("published").is_null());
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
      cli::run({"table", "III", (folder_ / "out-sipailou").string(), "--as", "csv"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("left out of table III"));
  EXPECT_THAT(other.err, HasSubstr("06/result.json is of data set sipailou, not helimos"));

  const cli::Answer elsewhere =
      cli::run({"table", "apollo", (folder_ / "out-sipailou").string(), "--as", "latex"});
  EXPECT_THAT(elsewhere.err, HasSubstr("left out of table apollo"));
  const cli::Answer latex =
      cli::run({"table", "II", (folder_ / "out-sipailou").string(), "--as", "latex"});
  EXPECT_THAT(latex.out, HasSubstr("$^\\dagger$ SIMULATED data"));

  fs::remove_all(folder_ / "out-helimos/helimos/Ouster");
  const cli::Answer part =
      cli::run({"table", "III", (folder_ / "out-helimos").string(), "--as", "markdown"});
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
    const std::string method = row.at("method");
    const bool is_papers = method == "HMM-MOS", is_dynablox = method == "Dynablox";
    const bool is_plus = method == "HMM-MOS plus";
    EXPECT_TRUE(is_papers || is_plus || is_dynablox || method == "LC Free Space (our reading)")
        << method;
    EXPECT_EQ(row.at("protocol"), is_papers || is_plus ? "doals-hmm" : "doals-dynablox");
    const bool near =
        row.at("setting").get<std::string>().find("range 0.5 to 20 m") != std::string::npos;
    EXPECT_EQ(row.at("section"), is_plus ? "" : near ? "range 20 m" : "full range") << row;
    EXPECT_TRUE(near || is_papers || is_plus || is_dynablox) << "published at 20 m alone";
    EXPECT_EQ(station.at("reasons"),
              (nlohmann::json{"simulated data", "12 labelled scans, published over 20"}));
    const std::string preset = near ? "doals-20m" : "doals-120m";
    const std::string of_method = is_papers     ? ""
                                  : is_plus     ? "-hmm-mos-plus"
                                  : is_dynablox ? "-dynablox"
                                                : "-lc-free-space";
    const std::vector<double> ious = scan_ious(folder_ / "out-doals" / (preset + of_method));
    ASSERT_EQ(ious.size(), 12U) << "six labelled scans in each recording";
    const double mean = std::accumulate(ious.begin(), ious.end(), 0.0) / 12.0;
    EXPECT_GT(mean, 0.0) << "the method found nothing";
    EXPECT_NEAR(station.at("measured").get<double>(), mean, 1e-12);
    EXPECT_EQ(station.at("sequences"),
              (nlohmann::json{"station/sequence_1 (simulated, scene mall, seed 1)",
                              "station/sequence_2 (simulated, scene mall, seed 2)"}));
    for (std::size_t c = 1; c < 4; ++c) {
      EXPECT_TRUE(row.at("cells").at(c).at("measured").is_null());
    }
  }
  EXPECT_EQ(filled, 7U) << "three methods at two ranges, one at one";
  const cli::Answer text = cli::run({"table", "i", (folder_ / "out-doals/doals-20m").string()});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("doals-20m: ST is station/sequence_1 (simulated, scene mall"));
}

/// The words behind "mosbench run DIR" in every command that table `name` gives for the first row
/// of HMM-MOS which a variant of this program computes.
std::set<std::vector<std::string>> command_words(const std::string& name) {
  const auto table = nlohmann::json::parse(cli::run({"table", name, "--as", "json"}).out);
  const std::string start = "mosbench run DIR ";
  std::set<std::vector<std::string>> commands;
  for (const auto& row : table.at("rows")) {
    if (row.at("method") != "HMM-MOS" || !commands.empty()) continue;
    for (const auto& cell : row.at("cells")) {
      const std::string reason = cell.at("reasons").at(0);
      const auto at = reason.find(start);
      if (at == std::string::npos) continue;
      std::istringstream words(reason.substr(at + start.size()));
      commands.insert({std::istream_iterator<std::string>(words), {}});
    }
  }
  return commands;
}

/// The scans of a small sequence as MOE stores them.
void make_moe_of(const fs::path& folder, std::size_t scans) {
  for (std::size_t k = 0; k < scans; ++k) {
    const auto points = read_bin(folder / "velodyne" / (cli::stem(k) + ".bin"));
    const auto truth =
        read_labels(folder / "labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
    const std::string count = std::to_string(points.size());
    std::ostringstream pcd, label;
    pcd << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << count
        << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA ascii\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
      pcd << points[i].x << ' ' << points[i].y << ' ' << points[i].z << '\n';
      label << (truth[i] == kMovingLabel ? "1 1 0\n" : "-1 0 -1\n");
    }
    write_file_atomic(folder / "pcd" / (cli::stem(k) + ".pcd"), pcd.str());
    write_file_atomic(folder / "label" / (cli::stem(k) + ".txt"), label.str());
  }
  fs::rename(folder / "poses.txt", folder / "gt_poses.txt");
  for (const char* other : {"velodyne", "labels", "calib.txt"}) fs::remove_all(folder / other);
}

/// nuScenes' moving points have ids from 1000 on.
void make_nuscenes_of(const fs::path& folder, std::size_t scans) {
  for (std::size_t k = 0; k < scans; ++k) {
    const fs::path file = folder / "labels" / (cli::stem(k) + ".label");
    std::vector<std::uint32_t> truth = read_labels(file, cli::kPointsPerScan);
    std::ranges::replace(truth, kMovingLabel, 1000U);
    write_labels(file, truth);
  }
}

class TableCommand : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sets, TableCommand, testing::Values("apollo", "moe", "mdetector"),
                         [](const auto& name) { return std::string(name.param); });

/// The data set is recorded, in its own folders, and short: nothing but the number of scans may
/// differ from what was published.
TEST_P(TableCommand, FillsTheCellsOfItsTable) {
  constexpr std::size_t kScans = 8;
  const std::string table = GetParam();
  const TempFolder folder;
  const std::map<std::string, std::vector<std::string>> sequences = {
      {"apollo", {"00", "03"}},
      {"moe", {"00", "01", "02"}},
      {"mdetector", {"Avia", "KITTI", "nuScenes", "Waymo"}}};
  for (const std::string& name : sequences.at(table)) {
    cli::write_small_sequence(folder / "data" / name, kScans);
    if (table == "moe") make_moe_of(folder / "data" / name, kScans);
    if (name == "nuScenes") make_nuscenes_of(folder / "data" / name, kScans);
  }
  const auto commands = command_words(table);
  ASSERT_FALSE(commands.empty());
  for (const std::vector<std::string>& words : commands) {
    std::vector<std::string> command = {"run", (folder / "data").string(), "--out",
                                        (folder / "out" / words.at(3)).string()};
    command.insert(command.end(), words.begin(), std::ranges::find(words, "--out"));
    const cli::Answer run = cli::run(command);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  const cli::Answer answer = cli::run({"table", table, (folder / "out").string(), "--as", "json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.err, "") << "nothing is left out";
  std::size_t filled = 0;
  const auto printed = nlohmann::json::parse(answer.out);
  for (const auto& row : printed.at("rows")) {
    for (const auto& cell : row.at("cells")) {
      if (cell.at("measured").is_null()) continue;
      ++filled;
      EXPECT_EQ(cell.at("published").is_null(), table == "apollo") << row;
      for (const auto& reason : cell.at("reasons")) {
        EXPECT_EQ(reason,
                  table == "apollo"
                      ? "16 labelled scans, published over 2500"
                      : "no interval: 8 scans, expected at least 100 in a row, or 20 that are "
                        "10 s apart");
      }
      EXPECT_EQ(cell.at("verdict"), "not comparable");
    }
  }
  EXPECT_EQ(filled, table == "apollo" ? 1U : sequences.at(table).size());
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
        cli::run({"run", std::string("table:") + wrong.name, "--data",
                  (folder_ / wrong.folder).string(), "--out", (folder_ / "out").string()});
    EXPECT_EQ(answer.exit_code, 3) << wrong.name << answer.out;
    EXPECT_THAT(answer.err, HasSubstr(wrong.found));
    EXPECT_THAT(answer.err, HasSubstr(wrong.expected));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << "nothing was run";
  }
}

TEST_F(Tables, ArePrintedWithoutResultsInEveryFormat) {
  for (const char* table : {"I", "II", "III", "apollo", "moe", "mdetector"}) {
    for (const char* format : {"markdown", "csv", "latex", "json"}) {
      const cli::Answer answer = cli::run({"table", table, "--as", format});
      ASSERT_EQ(answer.exit_code, 0) << answer.err;
      EXPECT_THAT(answer.out, HasSubstr("HMM-MOS"));
    }
  }
  EXPECT_EQ(cli::run({"table", "IV"}).exit_code, 2);
  EXPECT_EQ(cli::run({"table", "I", "--as", "word"}).exit_code, 2);
  EXPECT_EQ(cli::run({"table", "I", (folder_ / "nowhere").string()}).exit_code, 3);
  EXPECT_EQ(cli::run({"run", "table:kitti", "--data", folder_.path().string()}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
