#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "datasets/formats/scan_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// A box of 1.2 m that goes 0.2 m from scan to scan.
class Map : public testing::Test {
 protected:
  Map() { cli::write_small_sequence(folder_ / "room", 14); }
  cli::Answer map(std::vector<std::string> words) const {
    words.insert(words.begin(), {"map", folder_ / "room", "--out", folder_ / "out"});
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(Map, WritesPointsAndAFloorPlanAndTellsWhatWasRemoved) {
  const cli::Answer answer =
      map({"-o", (folder_ / "made/map.ply").string() + "," + (folder_ / "plan.yaml").string()});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("static kept %  moving removed %"));
  EXPECT_THAT(answer.out, HasSubstr("voxels that moving points alone hit are left as ghosts"));
  EXPECT_THAT(answer.out, HasSubstr("map in " + (folder_ / "made/map.ply").string()));
  EXPECT_GT(read_scan(folder_ / "made/map.ply").size(), 5000U);
  EXPECT_THAT(read_file(folder_ / "plan.yaml"), HasSubstr("image: plan.pgm"));
  EXPECT_THAT(read_file(folder_ / "plan.pgm"), testing::StartsWith("P5\n"));
  // The labels are there: the same command takes them.
  const cli::Answer again = map({"-o", folder_ / "again.ply"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(read_file(folder_ / "again.ply"), read_file(folder_ / "made/map.ply"));
}

TEST_F(Map, RefusesWhatIsNoMapBeforeItsWork) {
  for (const std::string name : {"map.las", "map"}) {
    const cli::Answer answer = map({"-o", name});
    EXPECT_EQ(answer.exit_code, 2) << name;
    EXPECT_THAT(answer.err, HasSubstr("expected .pcd or .ply for points, .pgm or .yaml"));
  }
  EXPECT_EQ(map({"-o", folder_ / "a.pgm", "--height", "2,0.2"}).exit_code, 2);
  EXPECT_EQ(map({"-o", folder_ / "a.pgm", "--height", "0.2"}).exit_code, 2);
  EXPECT_FALSE(is_there(folder_ / "out"));
}

TEST_F(Map, OfAMapIsAnError) {
  ASSERT_EQ(map({"-o", folder_ / "map.ply"}).exit_code, 0);
  const cli::Answer answer = cli::run(
      {"map", folder_ / "map.ply", "--out", folder_ / "of-map", "-o", folder_ / "second.ply"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("map.ply"));
  EXPECT_THAT(answer.err, HasSubstr("has 1 scan, in which nothing can be seen to move"));
  EXPECT_FALSE(is_there(folder_ / "second.ply"));
}

TEST_F(Map, TakesOneSequence) {
  cli::write_small_sequence(folder_ / "two/sequences/00", 3);
  cli::write_small_sequence(folder_ / "two/sequences/01", 3);
  const cli::Answer answer =
      cli::run({"map", folder_ / "two", "--out", folder_ / "out", "-o", folder_ / "map.ply"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("holds 2 sequences, expected one: --sequences NAME"));
}

}  // namespace
}  // namespace mosbench
