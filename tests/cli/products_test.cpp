#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/formats/scan_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::StartsWith;

/// A box of 1.2 m that goes 0.2 m from scan to scan.
class Products : public testing::Test {
 protected:
  Products() {
    cli::write_small_sequence(folder_ / "room", 14);
    std::vector<std::int64_t> stamps_ns;
    for (std::int64_t k = 0; k < 14; ++k) stamps_ns.push_back(5'000'000'000 + 100'000'000 * k);
    write_times(folder_ / "room/times.txt", stamps_ns);
  }

  void run(const std::string& products) const {
    std::vector<std::string> words = {"run", folder_ / "room", "--out", folder_ / "out"};
    if (!products.empty()) words.insert(words.end(), {"--write", products});
    const cli::Answer answer = cli::run(words);
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  std::filesystem::path out(const std::string& name) const {
    return folder_ / ("out/room/" + name);
  }

  TempFolder folder_;
};

std::size_t vertices_of(const std::string& ply) {
  EXPECT_THAT(ply, StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex "));
  return std::stoul(ply.substr(ply.find("vertex ") + 7));
}

std::size_t body_of(const std::string& ply) { return ply.size() - ply.find("end_header\n") - 11; }

TEST_F(Products, HoldBoxesWithTracksAndSpeeds) {
  run("boxes");
  const ordered_json scans = ordered_json::parse(read_file(out("boxes.json"))).at("scans");
  ASSERT_EQ(scans.size(), 14U);
  std::size_t boxes = 0;
  std::vector<double> speeds_m_s;
  for (const ordered_json& scan : scans) {
    const int index = std::stoi(scan.at("stem").get<std::string>());
    EXPECT_EQ(scan.at("stamp_ns"), 5'000'000'000 + 100'000'000LL * index);
    for (const ordered_json& box : scan.at("boxes")) {
      ++boxes;
      const ordered_json& velocity = box.at("velocity_map_m_s");
      if (velocity.is_null() || box.at("points") < 100) continue;
      speeds_m_s.push_back(std::hypot(velocity[0].get<double>(), velocity[1].get<double>()));
      EXPECT_EQ(box.at("track"), scans.back().at("boxes").at(0).at("track"));
      EXPECT_NEAR(box.at("centre_map_m")[0].get<double>(), 3.0, 0.2);
    }
  }
  // More of the box is found from scan to scan, so that its middle stays behind.
  ASSERT_GT(speeds_m_s.size(), 3U);
  std::ranges::sort(speeds_m_s);
  EXPECT_NEAR(speeds_m_s[speeds_m_s.size() / 2], 2.0, 0.7);
  std::istringstream rows(read_file(out("boxes.txt")));
  std::size_t count = 0;
  for (std::string row; std::getline(rows, row); ++count) {
    std::istringstream words(row);
    std::vector<std::string> fields;
    for (std::string word; words >> word;) fields.push_back(word);
    ASSERT_EQ(fields.size(), 17U) << row;
    EXPECT_EQ(fields[2], "Moving");
    EXPECT_NEAR(std::stod(fields[15]), 3.0, 0.4) << "z of the camera is x of the LiDAR";
  }
  EXPECT_EQ(count, boxes);
  EXPECT_FALSE(is_there(out("static.ply")));
}

TEST_F(Products, HoldWhatMovesAndWhatStandsStill) {
  run("moving-cloud,static-cloud");
  const ordered_json result = cli::timeless_result(folder_ / "out/room");
  std::size_t moving = 0;
  for (const ordered_json& scan : result.at("scans")) {
    const std::string ply = read_file(out("moving/" + scan.at("stem").get<std::string>() + ".ply"));
    const std::size_t points = vertices_of(ply);
    EXPECT_EQ(points, scan.at("predicted_moving_points"));
    EXPECT_EQ(body_of(ply), 16 * points);
    moving += points;
  }
  EXPECT_GT(moving, 100U);
  const std::string map = read_file(out("static.ply"));
  EXPECT_EQ(body_of(map), 28 * vertices_of(map));
  // 48 m of walls, 24 rows: at most a point per 0.1 m, and more than one scan's rays miss.
  EXPECT_GT(vertices_of(map), 5000U);
  EXPECT_LE(vertices_of(map), 13000U);
}

/// What static.pcd holds of the points of static.ply: the header of PCD 0.7, then four float32
/// each.
std::string pcd_of(const std::string& ply) {
  const std::string count = std::to_string(vertices_of(ply));
  std::string pcd =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\n"
      "SIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " +
      count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  for (std::size_t at = ply.size() - body_of(ply); at < ply.size(); at += 28) {
    std::array<double, 3> position_m{};
    std::memcpy(position_m.data(), ply.data() + at, 24);
    for (const double x_m : position_m) {
      const auto narrow_m = static_cast<float>(x_m);
      pcd.append(reinterpret_cast<const char*>(&narrow_m), 4);
    }
    pcd.append(ply, at + 24, 4);
  }
  return pcd;
}

TEST_F(Products, HoldTheStaticMapAsPcdWithTheSamePoints) {
  run("static-cloud,static-cloud-pcd");
  const std::string map = read_file(out("static.ply"));
  EXPECT_EQ(read_file(out("static.pcd")), pcd_of(map));
  std::filesystem::remove(out("static.ply"));
  std::filesystem::remove(out("static.pcd"));
  run("static-cloud-pcd");
  EXPECT_EQ(read_file(out("static.pcd")), pcd_of(map));
  EXPECT_FALSE(is_there(out("static.ply")));

  const std::vector<Point> points = read_scan(out("static.pcd"));
  ASSERT_EQ(points.size(), vertices_of(map));
  EXPECT_EQ(points.front().intensity, 0.5F);
  // A point of the wall that the map has, and one in the middle of the room that it has not.
  const auto truth = folder_.write(
      "truth.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty float intensity\nend_header\n-6 0.05 0.1 0\n0 0 0 1\n");
  const cli::Answer scored =
      cli::run({"map-score", out("static.pcd"), truth, "--same-within-m", "0.1", "--json"});
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto score = nlohmann::json::parse(scored.out);
  EXPECT_EQ(score.at("map").at("points"), points.size());
  EXPECT_EQ(score.at("sa"), 1.0);
  EXPECT_EQ(score.at("da"), 1.0);
}

TEST_F(Products, HoldNoPcdWherePosesAreTooFarForFloat32) {
  Pose far = Pose::Identity();
  far.translation().x() = 200'000.0;
  write_poses(folder_ / "room/poses.txt", std::vector<Pose>(14, far));
  run("static-cloud");
  const cli::Answer refused =
      cli::run({"run", folder_ / "room", "--out", folder_ / "out", "--write", "static-cloud-pcd"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("room/static.pcd: positions up to 200006 m are 0.015625 m "
                                     "apart in float32, expected poses nearer to their origin"));
  EXPECT_FALSE(is_there(out("static.pcd")));
}

TEST_F(Products, AreAddedToFinishedRunsAndKept) {
  run("");
  EXPECT_FALSE(is_there(out("boxes.json")));
  run("boxes,static-cloud");
  const auto first = cli::contents(folder_ / "out");
  std::filesystem::remove(out("static.ply"));
  run("boxes,static-cloud");
  EXPECT_EQ(cli::contents(folder_ / "out"), first);
  std::filesystem::remove(out("products.json"));
  write_file_atomic(out("boxes.txt"), "of another program");
  const cli::Answer foreign =
      cli::run({"run", folder_ / "room", "--out", folder_ / "out", "--write", "boxes"});
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("boxes.txt: was not written by mosbench run --write"));
  EXPECT_EQ(read_file(out("boxes.txt")), "of another program");
  std::filesystem::remove(out("boxes.txt"));
  run("boxes,static-cloud");
  EXPECT_EQ(cli::contents(folder_ / "out"), first);
  run("");
  EXPECT_TRUE(is_there(out("boxes.txt")));
  const cli::Answer unknown = cli::run({"run", folder_ / "room", "--write", "cubes"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("cubes"));
}

TEST_F(Products, AreMadeAfterAKillThatLeftOneHalfWritten) {
  run("");
  write_file_atomic(out("static.ply.mosbench.partial"), "ply");
  run("static-cloud");
  EXPECT_TRUE(is_there(out("static.ply")));
}

TEST_F(Products, ThatWereChangedAreRefused) {
  const std::string all = "boxes,moving-cloud,static-cloud,static-cloud-pcd";
  run(all);
  const auto whole = cli::contents(folder_ / "out");
  for (const char* file :
       {"boxes.json", "boxes.txt", "moving/000009.ply", "static.ply", "static.pcd"}) {
    const std::string bytes = read_file(out(file));
    write_file_atomic(out(file), bytes.substr(0, bytes.size() - 1));
    const std::vector<std::string> words = {"run", folder_ / "room", "--out", folder_ / "out"};
    EXPECT_EQ(cli::run(words).exit_code, 0);
    const cli::Answer refused =
        cli::run({"run", folder_ / "room", "--out", folder_ / "out", "--write", all});
    EXPECT_EQ(refused.exit_code, 2) << file;
    EXPECT_THAT(refused.err, HasSubstr(std::string(file) + ": was changed after the run"));
    std::filesystem::remove(out(file));
    run(all);
    EXPECT_EQ(cli::contents(folder_ / "out"), whole) << file;
  }
  write_file_atomic(out("products.json"), "[]");
  EXPECT_EQ(
      cli::run({"run", folder_ / "room", "--out", folder_ / "out", "--write", "boxes"}).exit_code,
      3);
}

}  // namespace
}  // namespace mosbench
