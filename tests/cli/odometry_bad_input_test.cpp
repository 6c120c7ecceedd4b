#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// What can be wrong with a drive, and what is said of it.
struct Mistake {
  const char* name;
  std::function<void(std::vector<std::vector<Point>>& scans, std::vector<double>& stamps_s)> make;
  int exit_code;
  const char* said;
};

std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.name; }

std::vector<Mistake> mistakes() {
  using Scans = std::vector<std::vector<Point>>;
  using Stamps = std::vector<double>;
  return {
      {"Nothing", [](Scans&, Stamps&) {}, 0, " 0 doubtful"},
      {"SomeNan",
       [](Scans& scans, Stamps&) {
         for (auto& scan : scans) scan.insert(scan.begin() + 9, 50, {kNan, 1, kNan, 0});
       },
       0, " 0 doubtful"},
      {"OneScanOfNan",
       [](Scans& scans, Stamps&) {
         for (Point& p : scans[3]) p = {kNan, kNan, kNan, kNan};
       },
       1, "scan 000003: only 0 points"},
      {"Infinite",
       [](Scans& scans, Stamps&) {
         for (Point& p : scans[3]) p.x = std::numeric_limits<float>::infinity();
       },
       1, "scan 000003: only 0 points"},
      {"Huge",
       [](Scans& scans, Stamps&) {
         for (Point& p : scans[3]) p = {1e30F, -1e30F, 1e30F, 0};
       },
       1, "scan 000003: only 0 points"},
      {"EmptyScan", [](Scans& scans, Stamps&) { scans[3].clear(); }, 1,
       "scan 000003: only 0 points"},
      {"EmptyFirstScan", [](Scans& scans, Stamps&) { scans[0].clear(); }, 1,
       "scan 000001: no scan before it could be used"},
      {"EmptyScansAlone",
       [](Scans& scans, Stamps&) {
         for (auto& scan : scans) scan.clear();
       },
       1, "6 doubtful"},
      {"MissingReturnsAlone",
       [](Scans& scans, Stamps&) {
         for (auto& scan : scans) scan.assign(1000, {0, 0, 0, 0});
       },
       1, "6 doubtful"},
      {"OnePlace",
       [](Scans& scans, Stamps&) {
         for (auto& scan : scans) scan.assign(1000, {3, 4, 0, 0});
       },
       1, "6 doubtful"},
      {"OneScan",
       [](Scans& scans, Stamps& stamps_s) {
         scans.resize(1);
         stamps_s.resize(1);
       },
       0, "1 pose "},
      {"GapOfManyScans",
       [](Scans& scans, Stamps& stamps_s) {
         for (int k = 3; k < 6; ++k) {
           scans[static_cast<std::size_t>(k)] =
               scene_points(street(), pose_at({0.5 * k + 20, 0, 0}, 0), k);
           stamps_s[static_cast<std::size_t>(k)] += 4;
         }
       },
       1, "scan 000003: "},
      {"OutOfOrder",
       [](Scans& scans, Stamps& stamps_s) {
         std::swap(scans[3], scans[4]);
         std::swap(stamps_s[3], stamps_s[4]);
       },
       1, "its stamp is not after that of the scan before"},
      {"RepeatedStamps", [](Scans&, Stamps& stamps_s) { stamps_s[3] = stamps_s[2]; }, 1,
       "scan 000003: its stamp is not after that of the scan before"},
  };
}

class BadDrives : public testing::TestWithParam<Mistake> {
 protected:
  void SetUp() override {
    std::vector<std::vector<Point>> scans;
    std::vector<double> stamps_s;
    for (int k = 0; k < 6; ++k) {
      scans.push_back(scene_points(street(), pose_at({0.5 * k, 0, 0}, 0), k));
      ASSERT_GT(scans.back().size(), 5000u);
      stamps_s.push_back(0.1 * k);
    }
    GetParam().make(scans, stamps_s);
    std::string times;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      write_bin(folder_ / "s" / "velodyne" / ("00000" + std::to_string(k) + ".bin"), scans[k]);
      times += std::to_string(stamps_s[k]) + "\n";
    }
    folder_.write("s/times.txt", times);
    scans_ = scans.size();
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }

  TempFolder folder_;
  std::size_t scans_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Odometry, BadDrives, testing::ValuesIn(mistakes()),
                         [](const auto& mistake) { return std::string(mistake.param.name); });

TEST_P(BadDrives, GetAPosePerScanAndSayWhichAreDoubtful) {
  for (const char* kind : {"simple", "kiss"}) {
    const cli::Answer found = cli::run(
        {"odometry", path("s"), "-o", path("poses.txt"), "--odometry", kind, "--overwrite"});
    ASSERT_EQ(found.exit_code, GetParam().exit_code) << kind << found.out << found.err;
    EXPECT_THAT(found.out, HasSubstr(GetParam().said)) << kind;
    // Refuses numbers that are not finite.
    EXPECT_EQ(read_poses(path("poses.txt")).size(), scans_) << kind;
  }
}

TEST_P(BadDrives, AreLabelledWithARemarkWherePosesAreDoubtful) {
  const cli::Answer run =
      cli::run({"run", path("s"), "--odometry", "simple", "--out", path("runs"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto remarks =
      nlohmann::ordered_json::parse(run.out).at("sequences")[0].at("remarks").dump();
  const bool doubtful = GetParam().exit_code == 1;
  EXPECT_EQ(remarks.find(" are doubtful") != std::string::npos, doubtful) << remarks;
  EXPECT_EQ(run.err.find(" are doubtful") != std::string::npos, doubtful) << run.err;
  const bool all = std::string(GetParam().said) == "6 doubtful";
  EXPECT_EQ(remarks.find("MOST POSES ARE DOUBTFUL") != std::string::npos, all) << remarks;
  EXPECT_EQ(read_poses(folder_ / "runs" / "s" / "poses.txt").size(), scans_);
  const auto listed =
      nlohmann::ordered_json::parse(read_file(folder_ / "runs/s/result.json")).at("doubtful_poses");
  EXPECT_EQ(listed.empty(), !doubtful) << listed;
  for (const auto& pose : listed) {
    EXPECT_FALSE(pose.at("stem").get<std::string>().empty());
    EXPECT_FALSE(pose.at("doubt").get<std::string>().empty());
  }
}

TEST_P(BadDrives, AreWrittenAsTumOnlyWhereStampsRise) {
  const std::string name = GetParam().name;
  const bool rises = name != "OutOfOrder" && name != "RepeatedStamps";
  const cli::Answer found = cli::run({"odometry", path("s"), "-o", path("poses.tum")});
  EXPECT_EQ(found.exit_code, rises ? GetParam().exit_code : 2) << found.err;
  EXPECT_EQ(std::filesystem::exists(path("poses.tum")), rises);
  if (rises) return;
  EXPECT_THAT(found.err, AllOf(HasSubstr("a file called *.tum, or tum:FILE"),
                               HasSubstr("is not after the one before, expected kitti:FILE")));
}

TEST_P(BadDrives, AreNotRegisteredWhereThePosesHaveNoPlace) {
  for (const std::string& place : {path("s"), path("new/")}) {
    const cli::Answer found = cli::run({"odometry", path("s"), "-o", place});
    EXPECT_EQ(found.exit_code, 3) << place;
    EXPECT_THAT(found.err, AllOf(HasSubstr("is a folder, expected a file to write"),
                                 testing::Not(HasSubstr("scan 1/"))));
    EXPECT_FALSE(std::filesystem::exists(path("new")));
  }
}

}  // namespace
}  // namespace mosbench
