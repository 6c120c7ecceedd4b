#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

/// A line for every command, some with several answers. SIM is a simulated data set, SIPAILOU one
/// of a paper's table, and OUT a folder; NEW is another one each time.
constexpr const char* kAnswered[] = {
    "simulate --layout semantickitti --scene room --scans 2 --seed 1 --out NEW",
    "run SIM --out OUT/run",
    "profile SIM --scans 2",
    "score SIM --predictions OUT/run",
    "report OUT/run -o NEW",
    "render OUT/run --scans 2 -o NEW.png",
    "table II OUT/run",
    "run table:II --data SIPAILOU --out OUT/reproduced",
    "rank OUT/run OUT/run",
    "stats OUT/run",
    "stats OUT/run --by range,height,object",
    "stats OUT/run --by threshold",
    "stats OUT/run --by scan",
    "run OUT/s.yaml --dry-run --out OUT/study",
    "rank OUT/s.yaml --out OUT/study",
    "compare OUT/run OUT/run",
    "compare OUT/run OUT/run --by sequence",
    "compare OUT/run OUT/run --by scan,object",
    "info SIM",
    "doctor SIM",
    "odometry SIM -o NEW",
    "trajectory OUT/poses.txt --truth SIM",
    "map SIM --method hmm-mos --out NEW -o NEW.ply",
    "convert SIM --layout helimos --out NEW",
    "truth propose SIM -o NEW",
    "list",
    "help",
};

class Formats : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* layout : {"semantickitti", "sipailou"}) {
      const auto made = cli::run({"simulate", "--layout", layout, "--scene", "room", "--scans", "5",
                                  "--seed", "1", "--out", folder_ / layout});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    folder_.write("s.yaml", "name: s\ndata: {name: room, path: semantickitti}\nmethods: [yoon]\n");
    ASSERT_EQ(ask("run SIM --out OUT/run --write scores").exit_code, 0);
    ASSERT_LE(ask("odometry SIM -o OUT/poses.txt").exit_code, 1);
  }

  cli::Answer ask(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream text(line);
    for (std::string word; text >> word;) {
      for (const auto& [name, path] :
           {std::pair<std::string, std::string>{"SIM", folder_ / "semantickitti"},
            {"SIPAILOU", folder_ / "sipailou"},
            {"NEW", folder_ / fmt::format("new{}", asked_)},
            {"OUT", folder_.path()}}) {
        if (word.starts_with(name)) word.replace(0, name.size(), path);
      }
      words.push_back(word);
    }
    ++asked_;
    return cli::run(words);
  }

  TempFolder folder_;
  std::size_t asked_ = 0;
};

void expect_format(const std::string& out, Format format) {
  switch (format) {
    case Format::kJson:
      EXPECT_TRUE(nlohmann::json::accept(out)) << out;
      break;
    case Format::kHtml:
      EXPECT_THAT(out, ContainsRegex("^<!(doctype|DOCTYPE) html>"));
      break;
    case Format::kPng:
      EXPECT_THAT(out, StartsWith("\x89PNG"));
      break;
    default:
      EXPECT_NE(out, "");
  }
}

TEST_F(Formats, OfEveryCommandAreAllTakenOrClearlyRefused) {
  for (const Command& command : commands()) {
    EXPECT_TRUE(std::ranges::any_of(kAnswered, [&](const std::string& line) {
      return line.starts_with(command.name);
    })) << command.name;
  }
  for (const std::string line : kAnswered) {
    for (const std::string_view name : format_names()) {
      const std::string asked = fmt::format("{} --as {}", line, name);
      SCOPED_TRACE(asked);
      const cli::Answer answer = ask(asked);
      if ((name == "png" || name == "junit") && answer.exit_code == 2) {
        EXPECT_THAT(answer.err, HasSubstr("--as"));
        EXPECT_EQ(answer.out, "");
        continue;
      }
      ASSERT_LE(answer.exit_code, 1) << answer.err;
      expect_format(answer.out, format_named(name));
    }
  }
}

}  // namespace
}  // namespace mosbench
