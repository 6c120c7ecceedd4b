#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string said_by(const std::vector<std::string>& words) {
  const cli::Answer answer = cli::run(words);
  EXPECT_LE(answer.exit_code, 1) << answer.err;
  return answer.out;
}

/// A simulated street, and a recorded room of as many scans.
class PoseMarks : public testing::Test {
 protected:
  void SetUp() override {
    cli::write_small_sequence(folder_ / "room", 6);
    said_by({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans", "6", "--seed",
             "3", "--out", folder_ / "sim"});
  }
  /// Where a file of poses lies once it was copied with what lies beside it.
  std::string moved(const std::string& file) const {
    fs::create_directories(folder_ / "elsewhere");
    for (const char* end : {"", ".frame"}) {
      if (!fs::exists(folder_ / (file + end))) continue;
      fs::rename(folder_ / (file + end), folder_ / "elsewhere" / (file + end));
    }
    return folder_ / "elsewhere" / file;
  }
  /// Expects that a run of the room by these poses, and what shows it, say so, as does a
  /// trajectory.
  void expect_said(const std::string& poses, const std::string& doubt) const {
    const std::string out = folder_ / "runs" / fs::path(poses).filename();
    EXPECT_THAT(said_by({"run", folder_ / "room", "--poses", poses, "--out", out}),
                HasSubstr(doubt));
    EXPECT_THAT(said_by({"stats", out}), HasSubstr(doubt));
    EXPECT_THAT(said_by({"stats", out, "--as", "json"}), HasSubstr(doubt));
    const bool is_mark = doubt.find("simulated scans") != doubt.npos;
    EXPECT_THAT(said_by_trajectory(poses), HasSubstr(is_mark ? "SIMULATED data" : doubt));
  }

  std::string said_by_trajectory(const std::string& poses) const {
    return said_by({"trajectory", poses, "--truth", folder_ / "room/poses.txt"});
  }

  TempFolder folder_;
};

TEST_F(PoseMarks, AreDoubtsOfThePosesThatWereFound) {
  const std::string found = said_by({"odometry", folder_ / "sim", "-o", folder_ / "p.txt"});
  EXPECT_THAT(found, AllOf(HasSubstr("SIMULATED"), Not(HasSubstr("poses are equal"))));
  const std::string still = said_by({"odometry", folder_ / "room", "-o", folder_ / "none.txt",
                                     "--set", "min_range_m=900,max_range_m=901"});
  EXPECT_THAT(still,
              AllOf(HasSubstr("all 6 poses are equal"),
                    HasSubstr("6 of 6 poses found are doubtful, first that of scan 000000")));
  EXPECT_THAT(read_file(folder_ / "none.txt.frame"),
              HasSubstr("doubt: 6 of 6 poses found are doubtful, first that of scan 000000"));
}

TEST_F(PoseMarks, OfDisturbedScansStayWithTheFile) {
  for (const std::string file : {"p.txt", "p.tum"}) {
    said_by({"odometry", folder_ / "sim", "--perturb", "range_noise_m=0.02,seed=3", "-o",
             folder_ / file});
    const std::string poses = moved(file);
    if (file == "p.txt") {
      expect_said(poses, "p.txt: disturbed on purpose by range_noise_m=0.02,seed=3");
      expect_said(poses, "p.txt: poses of simulated scans (scene street, seed 3)");
    }
    const std::string path =
        said_by({"trajectory", poses, "--truth", folder_ / "room/poses.txt", "--as", "json"});
    EXPECT_THAT(path, AllOf(HasSubstr("disturbed on purpose by range_noise_m=0.02,seed=3"),
                            HasSubstr("scene street, seed 3")))
        << file;
  }
}

TEST_F(PoseMarks, OfDoubtfulPosesStayWithTheFileOfARunToo) {
  const std::vector<std::string> far = {"min_range_m=900,max_range_m=901"};
  said_by({"odometry", folder_ / "room", "--set", far[0], "-o", folder_ / "p.txt"});
  expect_said(moved("p.txt"), "p.txt: 6 of 6 poses found are doubtful");
  said_by({"convert", folder_ / "room", "--poses", folder_ / "elsewhere/p.txt", "--layout",
           "semantickitti", "--out", folder_ / "copy"});
  EXPECT_THAT(said_by_trajectory(folder_ / "copy/sequences/room"),
              HasSubstr("p.txt: 6 of 6 poses found are doubtful"));
  said_by({"run", folder_ / "room", "--odometry", "simple", "--odometry-set", far[0], "--out",
           folder_ / "found"});
  expect_said(folder_ / "found/room/poses.txt", "poses.txt: 6 of 6 poses found are doubtful");
}

TEST_F(PoseMarks, SayNothingWhereTheScansAreOfTheSameSimulationOrTheFileIsAnother) {
  said_by({"odometry", folder_ / "sim", "-o", folder_ / "p.txt"});
  EXPECT_THAT(
      said_by({"run", folder_ / "sim", "--poses", folder_ / "p.txt", "--out", folder_ / "own"}),
      Not(HasSubstr("poses of simulated scans")));
  fs::copy_file(folder_ / "room/poses.txt", folder_ / "p.txt",
                fs::copy_options::overwrite_existing);
  const std::string other = "p.txt: p.txt.frame is of other poses";
  EXPECT_THAT(
      said_by({"run", folder_ / "room", "--poses", folder_ / "p.txt", "--out", folder_ / "other"}),
      AllOf(HasSubstr(other), Not(HasSubstr("simulated"))));
  EXPECT_THAT(said_by_trajectory(folder_ / "p.txt"), HasSubstr(other));
}

TEST_F(PoseMarks, DoNotSayOfAllOfACopyThatItIsAPart) {
  const auto part = HasSubstr("only a part of the sequence is read");
  said_by({"convert", folder_ / "room", "--scans", ":4", "--layout", "semantickitti", "--out",
           folder_ / "copy"});
  EXPECT_THAT(read_file(folder_ / "copy/sequences/room/pose_origin.txt"), Not(part));
  EXPECT_THAT(said_by({"odometry", folder_ / "sim", "--scans", ":4", "-o", folder_ / "p.tum"}),
              part);
  EXPECT_THAT(read_file(folder_ / "p.tum.frame"), Not(part));
}

}  // namespace
}  // namespace mosbench
