#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/text/text.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Clears a screen, in C0 and in C1, and rings.
const std::string kSteering =
    "\x1b[2J\xc2\x9b"
    "2J\x07\x7f";
const std::string kShown = "\\x1b[2J\\xc2\\x9b2J\\x07\\x7f";

TEST(HostileNames, OfFilesDoNotReachATerminal) {
  const TempFolder folder;
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"stats", folder / kSteering},
                                             {"run", folder / kSteering},
                                             {"doctor", folder / kSteering},
                                             {kSteering},
                                             {"stats", "--" + kSteering},
                                             {"run", folder.path(), "--method", kSteering}}) {
    const cli::Answer answer = cli::run(command);
    EXPECT_NE(answer.exit_code, 0);
    EXPECT_EQ(shown(answer.out), answer.out);
    EXPECT_EQ(shown(answer.err), answer.err);
    EXPECT_THAT(answer.out + answer.err, HasSubstr(kShown));
  }
}

TEST(HostileNames, OfMethodsDoNotReachATerminal) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 3);
  fs::copy(folder / "room/labels", folder / "mine");
  const std::string out = folder / "out";
  ASSERT_EQ(cli::run({"score", folder / "room", "--predictions", folder / "mine", "--method",
                      kSteering, "--out", out})
                .exit_code,
            0);
  const cli::Answer text = cli::run({"stats", out});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr(kShown));
  EXPECT_EQ(shown(text.out), text.out);
  const cli::Answer json = cli::run({"stats", out, "--json"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(shown(json.out), json.out);
  EXPECT_THAT(json.out, HasSubstr("\\u001b[2J\\u009b2J\\u0007\\u007f"));
  EXPECT_EQ(nlohmann::json::parse(json.out).at("method"), kSteering);
}

TEST(HostileNames, OfScansThatAreNoUtf8AreEscapedInResultsAndReports) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 3);
  fs::rename(folder / "room/velodyne/000001.bin", folder / "room/velodyne/1\xff.bin");
  fs::rename(folder / "room/labels/000001.label", folder / "room/labels/1\xff.label");
  const fs::path out = folder / "out\xff";
  const std::vector<std::string> command = {"run", folder / "room", "--out", out};
  const cli::Answer run = cli::run(command);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(is_there(out / "room/labels/1\\xff.label"));
  EXPECT_THAT(cli::run(command).err, HasSubstr("finished by an earlier run, kept"));
  for (const fs::path& labels : {out, folder / "mine"}) {
    if (labels != out) fs::copy(folder / "room/labels", labels);
    const cli::Answer score =
        cli::run({"score", folder / "room", "--predictions", labels, "--format", "label"});
    EXPECT_EQ(score.exit_code, 0) << score.err;
  }
  const cli::Answer report = cli::run({"report", out, "-o", folder / "report.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(read_file(folder / "report.html"), HasSubstr("1\\\\xff"));
}

TEST(HostileNames, OfSequencesThatAreNoUtf8AreShownEscaped) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "data/sequences/08\xff", 3);
  const cli::Answer answer = cli::run({"run", folder / "data", "--out", folder / "out"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("sequences/08\\xff: names the sequence \"08\\xff\""));
}

}  // namespace
}  // namespace mosbench
