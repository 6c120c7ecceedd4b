#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

/// An ASCII .ply file with the rows "x y z intensity".
std::string ply_of(const std::vector<std::string>& rows) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(rows.size()) + "\n";
  for (const char* name : {"x", "y", "z", "intensity"}) {
    text.append("property float ").append(name).append("\n");
  }
  text += "end_header\n";
  for (const std::string& row : rows) text.append(row).append("\n");
  return text;
}

TEST(MapScoreCommand, TellsHowMuchOfBothAMapHolds) {
  const TempFolder folder;
  const auto map = folder.write("cleaned.ply", ply_of({"0 0 0.01 0", "1 0 0 0", "5 0 0 0"}));
  const auto truth = folder.write(
      "gt.ply", ply_of({"0 0 0 0", "1 0 0 0", "2 0 0 0", "3 0 0 0", "5 0 0 1", "6 0 0 1"}));
  const cli::Answer text = cli::run({"map-score", map, truth});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, testing::ContainsRegex("2 of 4 +SA +50.00"));
  EXPECT_THAT(text.out, testing::ContainsRegex("1 of 2 +DA +50.00"));
  EXPECT_THAT(text.out, testing::ContainsRegex("AA +50.00"));
  EXPECT_THAT(text.out, testing::ContainsRegex("HA +50.00"));
  const auto json = nlohmann::json::parse(cli::run({"map-score", map, truth, "--json"}).out);
  EXPECT_EQ(json.at("sa"), 0.5);
  EXPECT_EQ(json.at("removed_dynamic"), 1);
  const auto far = nlohmann::json::parse(
      cli::run({"map-score", map, truth, "--same-within-m", "1", "--json"}).out);
  EXPECT_EQ(far.at("sa"), 0.75);
}

TEST(MapScoreCommand, RefusesWhatIsNoTruth) {
  const TempFolder folder;
  const auto map = folder.write("map.ply", ply_of({"0 0 0 0"}));
  const auto refused = [&](const std::string& rows) {
    const auto truth = folder.write("truth.ply", ply_of({"0 0 0 0", rows}));
    const cli::Answer answer = cli::run({"map-score", map, truth});
    EXPECT_EQ(answer.exit_code, 3);
    return answer.err;
  };
  EXPECT_THAT(refused("1 0 0 0.5"),
              EndsWith("has intensity 0.5, expected 0 (static) or 1 (dynamic), as KTH's truth\n"));
  EXPECT_THAT(refused("nan 0 0 1"), HasSubstr("point 1 is not finite"));
  EXPECT_THAT(refused("400000 0 0 1"),
              HasSubstr("truth.ply: positions up to 400000 m are 0.03125 m"));
  const auto truth = folder.write("gt.ply", ply_of({"0 0 0 0"}));
  EXPECT_THAT(cli::run({"map-score", folder.write("map.bin", std::string(48, 'a')), truth}).err,
              HasSubstr("map.bin: does not say what its columns are"));
  const auto empty = folder.write("empty.ply", ply_of({}));
  EXPECT_THAT(cli::run({"map-score", map, empty}).err, HasSubstr("empty.ply: holds no point"));
  EXPECT_THAT(cli::run({"map-score", map, folder.path()}).err, HasSubstr("gt_cloud.pcd"));
  EXPECT_EQ(cli::run({"map-score", map, empty, "--same-within-m", "0"}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
