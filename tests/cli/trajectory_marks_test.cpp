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

/// A recorded, a simulated and a disturbed sequence of six scans.
class TrajectoryMarks : public testing::Test {
 protected:
  void SetUp() override {
    cli::write_small_sequence(folder_ / "room", 6);
    simulate("a", "12");
    simulate("b", "1");
    const cli::Answer disturbed =
        cli::run({"convert", folder_ / "room", "--perturb", "pose_noise_m=0.1,seed=3", "--layout",
                  "semantickitti", "--out", folder_ / "set"});
    ASSERT_EQ(disturbed.exit_code, 0) << disturbed.err;
  }
  void simulate(const char* name, const char* seed) const {
    const cli::Answer answer = cli::run({"simulate", "--layout", "semantickitti", "--scene", "room",
                                         "--scans", "6", "--seed", seed, "--out", folder_ / name});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  std::string shown(std::vector<std::string> estimates, const std::string& as = "text") const {
    std::vector<std::string> words = {"trajectory"};
    words.insert(words.end(), estimates.begin(), estimates.end());
    words.insert(words.end(), {"--truth", folder_ / "room", "--as", as});
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return answer.out;
  }

  TempFolder folder_;
};

TEST_F(TrajectoryMarks, AreThoseOfBothEstimatesInEveryFormat) {
  const std::string plain = folder_ / "room/poses.txt";
  const std::string simulated = folder_ / "a/sequences/08/poses.txt";
  const std::string disturbed = folder_ / "set/sequences/room/poses.txt";
  EXPECT_THAT(shown({plain}), AllOf(Not(HasSubstr("SIMULATED")), Not(HasSubstr("disturbed"))));
  for (const char* as : {"text", "json", "csv", "markdown", "html"}) {
    for (const std::vector<std::string>& both :
         {std::vector<std::string>{simulated, disturbed}, {disturbed, simulated}}) {
      EXPECT_THAT(shown(both, as),
                  AllOf(HasSubstr("SIMULATED data (scene room, seed 12"),
                        HasSubstr("disturbed on purpose by pose_noise_m=0.1,seed=3")))
          << as;
    }
  }
  EXPECT_THAT(shown({simulated, folder_ / "b"}),
              HasSubstr("SIMULATED data (scene room, seed 12; scene room, seed 1"));
}

}  // namespace
}  // namespace mosbench
