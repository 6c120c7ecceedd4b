#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(Help, ShowsExamplesAtEachLevel) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"run", "--help"},
                                                    {"profile", "--help"},
                                                    {"score", "--help"},
                                                    {"simulate", "--help"},
                                                    {"table", "--help"},
                                                    {"reproduce", "--help"},
                                                    {"stats", "--help"},
                                                    {"breakdown", "--help"},
                                                    {"diff", "--help"},
                                                    {"compare", "--help"},
                                                    {"list", "--help"}}) {
    const cli::Answer answer = cli::run(arguments);
    EXPECT_EQ(answer.exit_code, 0) << arguments.front();
    EXPECT_THAT(answer.out, HasSubstr("Examples:\n  mosbench ")) << arguments.front();
    EXPECT_EQ(answer.err, "");
  }
}

TEST(Help, OfRunSaysThatAnInterruptedSequenceStartsAnew) {
  EXPECT_THAT(cli::run({"run", "--help"}).out, HasSubstr("starts an interrupted one anew"));
}

TEST(Version, NamesProgramAndCompiler) {
  const cli::Answer answer = cli::run({"--version"});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_THAT(answer.out, testing::MatchesRegex("mosbench [0-9].* \\(.+\\)\n"));
}

TEST(Usage, IsRefusedWithExitCode2AndAPrefixedMessage) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {},
           {"rum"},
           {"run"},
           {"run", "x", "--no-such-flag"},
           {"run", "x", "--threads", "0"},
           {"run", "x", "--threads", "many"},
           {"list", "nonsense"},
           {"score", "x"},
           {"simulate", "--layout", "doals", "--scene", "room", "--out", "x", "--seed", "-1"},
           {"simulate", "--layout", "doals"}}) {
    const cli::Answer answer = cli::run(arguments);
    EXPECT_EQ(answer.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(answer.err, StartsWith("mosbench: ")) << testing::PrintToString(arguments);
    EXPECT_EQ(answer.out, "") << testing::PrintToString(arguments);
  }
}

TEST(Usage, NamesAnUnknownCommand) {
  EXPECT_THAT(cli::run({"rum"}).err, HasSubstr("'rum' is not a command"));
}

TEST(List, ShowsDatasetsPresetsProtocolsAndScenes) {
  const std::string all = cli::run({"list"}).out;
  std::string parts;
  for (const char* what : {"datasets", "presets", "protocols", "scenes", "formats"}) {
    const cli::Answer answer = cli::run({"list", what});
    EXPECT_EQ(answer.exit_code, 0) << what;
    EXPECT_THAT(all, HasSubstr(answer.out)) << what;
    parts += answer.out;
  }
  for (const char* name :
       {"DOI 10.3929/ethz-c-000788171", "velodyne/%06d.bin", "doals-20m", "doals-120m", "sipailou",
        "helimos-delayed", "semantickitti", "doals-hmm", "mapmos", "room"}) {
    EXPECT_THAT(parts, HasSubstr(name));
  }
}

TEST(Stdout, ThatIsFullOrClosedIsAnError) {
  const cli::Answer full =
      cli::run({"list"}, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); });
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr("mosbench: stdout: cannot be written"));
  const cli::Answer closed = cli::run({"list"}, [] { close(STDOUT_FILENO); });
  EXPECT_EQ(closed.exit_code, 3);
  EXPECT_THAT(closed.err, HasSubstr("mosbench: stdout: is closed"));
}

}  // namespace
}  // namespace mosbench
