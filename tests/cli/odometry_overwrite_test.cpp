#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Runs `command`, which must be refused and change nothing in `folder`, then with --overwrite.
void expect_refusal(std::vector<std::string> command, const fs::path& folder,
                    const std::string& message) {
  const auto before = cli::contents(folder);
  const cli::Answer refused = cli::run(command);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr(message), HasSubstr("--overwrite"), Not(HasSubstr("scan 1/"))));
  EXPECT_EQ(cli::contents(folder), before);
  command.emplace_back("--overwrite");
  EXPECT_LE(cli::run(command).exit_code, 1);
  EXPECT_NE(cli::contents(folder), before);
}

TEST(OdometryOverwrite, IsNeededToReplacePosesAndMarks) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 3);
  const fs::path mine = folder / "mine";
  const std::vector<std::string> command = {"odometry", folder / "room", "-o", mine / "p.txt"};
  folder.write("mine/p.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  expect_refusal(command, mine, "mine/p.txt: is there already");
  fs::remove(mine / "p.txt");
  folder.write("mine/p.txt.frame", "my frame\n");
  expect_refusal(command, mine, "mine/p.txt.frame: is there already");
  // Nothing is lost with an empty file, or with the mark of other poses.
  folder.write("mine/p.txt", "");
  EXPECT_LE(cli::run(command).exit_code, 1);
  EXPECT_EQ(read_poses(mine / "p.txt").size(), 3U);
}

TEST(OdometryOverwrite, IsNeededToReplaceFilesOfSeveralSequences) {
  const TempFolder folder;
  for (const char* name : {"set/a", "set/b"}) cli::write_small_sequence(folder / name, 3);
  const fs::path poses = folder / "poses";
  const std::vector<std::string> command = {"odometry", folder / "set", "-o", poses};
  const std::vector<std::pair<std::string, std::string>> theirs = {
      {"b.txt", "b.txt: is there already"},
      {"b.txt.frame", "b.txt.frame: is there already"},
      {"b.json", "b.json: was not written by mosbench odometry"}};
  for (const auto& [name, message] : theirs) {
    fs::remove_all(poses);
    folder.write("poses/" + name, "my notes\n");
    expect_refusal(command, poses, message);
  }
  // Poses that somebody edited, and those of another question.
  std::ofstream(poses / "a.txt", std::ios::app) << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expect_refusal(command, poses, "a.txt: is there already");
  expect_refusal({"odometry", folder / "set", "-o", poses, "--set", "max_range_m=50"}, poses,
                 "a.json: belongs to other poses (");
}

}  // namespace
}  // namespace mosbench
