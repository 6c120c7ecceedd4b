#include "eval/cli/old_words.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "eval/cli/commands.hpp"
#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// A line of an earlier release and that of today. SIM is a simulated data set, OUT a folder.
struct OldLine {
  const char *old, *now;
};

constexpr OldLine kLines[] = {
    {"leaderboard OUT/run", "rank OUT/run"},
    {"completion bash", "help --completion bash"},
    {"curve OUT/run --format csv", "stats OUT/run --by threshold --as csv"},
    {"rank OUT/run --format=csv", "rank OUT/run --as csv"},
    {"table I --format latex", "table I --as latex"},
    {"compare OUT/run OUT/run --output-format github", "compare OUT/run OUT/run --as github"},
    {"breakdown SIM --predictions OUT/run --top 5",
     "stats SIM --by range,height,object --predictions OUT/run --top 5"},
    {"stats OUT/run OUT/run --json", "compare OUT/run OUT/run --by sequence --json"},
    {"stats OUT/run --csv", "stats OUT/run --as csv"},
    {"stats OUT/run --per-scan --json", "stats OUT/run --json --by scan"},
    {"diff OUT/run OUT/run --data SIM", "compare OUT/run OUT/run --by scan,object --data SIM"},
    {"bless OUT/run OUT/base", "compare OUT/base OUT/run --accept"},
    {"map-score OUT/map.ply OUT/truth.ply --same-within-m 0.1",
     "score OUT/truth.ply --map OUT/map.ply --same-within-m 0.1"},
    {"help leaderboard", "help rank"},
    {"reproduce doals --data SIM --out OUT/no --format csv",
     "run table:doals --data SIM --out OUT/no --as csv"},
    {"study OUT/s.yaml --out OUT/s --profile OUT/no", "run OUT/s.yaml --out OUT/s --on OUT/no"},
    {"study run OUT/s.yaml --out OUT/s --profile OUT/no", "run OUT/s.yaml --out OUT/s --on OUT/no"},
    {"study plan OUT/s.yaml --measure --out OUT/s", "run OUT/s.yaml --dry-run --out OUT/s"},
    {"study cell OUT/s.yaml 01 02 --out OUT/s", "run OUT/s.yaml --only 01,02 --out OUT/s"},
    {"study table OUT/s.yaml --out OUT/s --format csv --output OUT/s.csv",
     "rank OUT/s.yaml --out OUT/s --as csv -o OUT/s.csv"},
    {"profile OUT/no --trace OUT/t.json", "profile OUT/no --out OUT/t.json"},
    {"trajectory OUT/t.txt --truth SIM --per-pose --plot OUT/x.png",
     "trajectory OUT/t.txt --truth SIM --out OUT/x.png --by pose"},
    {"doctor SIM --pose-format kitti --pose-frame lidar --pose-direction map-from-sensor",
     "doctor SIM --read pose_format=kitti,pose_frame=lidar,pose_direction=map-from-sensor"},
    {"doctor SIM --max-pose-gap-s=1 --map-frame a --pose-topic b",
     "doctor SIM --read max_pose_gap_s=1,map_frame=a,pose_topic=b"},
    {"doctor SIM --bin-columns 4 --moving-speed-m-s 1",
     "doctor SIM --read bin_columns=4,moving_speed_m_s=1"},
    {"run SIM --hdl64-correction --raw-scans --out OUT/old",
     "run SIM --out OUT/old --read hdl64_correction=on --deskew none"},
    {"run SIM --config OUT/c.json --variant release-2025 --out OUT/old2",
     "run SIM --out OUT/old2 --set @OUT/c.json,variant=release-2025"},
    {"run SIM --moving ever --method hmm-mos-plus --scores --out OUT/old3",
     "run SIM --method hmm-mos-plus --out OUT/old3 --set moving=ever --write scores"},
    {"odometry SIM -o OUT/p.txt --preset kitti-online --config OUT/o.json --set min_range_m=1",
     "odometry SIM -o OUT/p.txt --odometry :kitti-online,@OUT/o.json,min_range_m=1"},
    {"run SIM --odometry simple --odometry-preset kitti-online --odometry-config OUT/o.json "
     "--odometry-set min_range_m=1 --drop-moving --out OUT/old4",
     "run SIM --odometry simple:kitti-online,@OUT/o.json,min_range_m=1,drop_moving=on --out "
     "OUT/old4"},
    {"odometry SIM --format tum -o OUT/p.txt", "odometry SIM -o tum:OUT/p.txt"},
    {"convert SIM --layout ros2-db3 --compression lz4 --out OUT/bag",
     "convert SIM --layout ros2-db3:lz4 --out OUT/bag"},
    {"score SIM --predictions OUT/run --mask 0,50 --setting s",
     "score SIM --predictions OUT/run --format label-masked:0,50 --method 'unnamed, s'"},
    {"score SIM --predictions OUT/run --level object --method m --setting s",
     "score SIM --predictions OUT/run --method 'm, s' --format dynablox:object"},
    {"trajectory OUT/t.txt --truth SIM --format kitti --max-time-difference-s 0.1 --delta-m 1 "
     "--all-pairs",
     "trajectory OUT/t.txt --truth SIM --read pose_format=kitti,max_time_difference_s=0.1 --delta "
     "1m,all"},
    {"trajectory OUT/t.txt --truth SIM --camera truth --calib SIM/sequences/08/calib.txt",
     "trajectory OUT/t.txt --truth SIM --camera truth:SIM/sequences/08/calib.txt"},
    {"trajectory OUT/t.txt --truth SIM --csv", "trajectory OUT/t.txt --truth SIM --as csv"},
    {"render OUT/run --scan 2 --sequence 08 --azimuth 30 --boxes --reasons -o OUT/x.png",
     "render OUT/run -o OUT/x.png --scans 2 --sequences 08 --view orbit:30 --show boxes,reasons"},
    {"render OUT/run --scans 1-2 --view orbit --turn 90 -o OUT/pictures",
     "render OUT/run --scans 1-2 --view orbit+90 -o OUT/pictures"},
};

bool holds(const std::string& line, std::string_view word) {
  return (' ' + line + ' ').find(fmt::format(" {} ", word)) != std::string::npos ||
         line.find(fmt::format(" {}=", word)) != std::string::npos;
}

class OldWords : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const auto made = cli::run({"simulate", "--layout", "semantickitti", "--scene", "room",
                                "--scans", "5", "--seed", "1", "--out", *folder_ / "sim"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    ASSERT_EQ(ask("run SIM --out OUT/run --write scores").exit_code, 0);
    folder_->write("c.json", "{\"max_range_m\": 30}");
    folder_->write("o.json", "{}");
    folder_->write("s.yaml",
                   "name: s\nprotocol: sipailou\nmethods: [underwood]\ndata: {name: small, "
                   "path: " +
                       (*folder_ / "sim").string() + "}\n");
    ASSERT_LE(ask("odometry SIM -o OUT/t.txt").exit_code, 1);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string filled(std::string line) {
    for (const auto& [name, path] :
         {std::pair<std::string, std::string>{"SIM", *folder_ / "sim"}, {"OUT", folder_->path()}}) {
      for (std::size_t at = 0; (at = line.find(name, at)) != std::string::npos;) {
        line.replace(at, name.size(), path);
      }
    }
    return line;
  }

  static cli::Answer ask(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream text(filled(line));
    for (std::string word; text >> word;) {
      if (word.starts_with('\'')) {
        std::string rest;
        std::getline(text, rest, '\'');
        word = word.substr(1) + rest;
      }
      words.push_back(word);
    }
    return cli::run(words);
  }

  static TempFolder* folder_;
};

TempFolder* OldWords::folder_ = nullptr;

TEST_F(OldWords, DoWhatTheirNewLineDoesAndNameIt) {
  for (const OldLine& line : kLines) {
    (void)ask(line.old);  // so that times of a run are those that it kept
    const cli::Answer old = ask(line.old), now = ask(line.now);
    EXPECT_THAT(old.err, HasSubstr("\n  mosbench " + filled(line.now) + "\n")) << line.old;
    EXPECT_EQ(old.out, now.out) << line.old;
    EXPECT_EQ(old.exit_code, now.exit_code) << line.old;
    EXPECT_EQ(now.err.find("the next release"), std::string::npos) << now.err;
  }
}

TEST_F(OldWords, AreAllAmongTheLines) {
  for (const OldCommand& old : old_commands()) {
    EXPECT_TRUE(std::ranges::any_of(kLines, [&](const OldLine& line) {
      return std::string_view(line.old).starts_with(old.name);
    })) << old.name;
  }
  for (const OldFlag& old : old_flags()) {
    EXPECT_TRUE(std::ranges::any_of(kLines,
                                    [&](const OldLine& line) {
                                      const std::string command = std::string(line.old).substr(
                                          0, std::string(line.old).find(' '));
                                      return holds(line.old, old.flag) &&
                                             holds(std::string(old.commands), command);
                                    }))
        << old.commands << ": " << old.flag;
  }
}

/// The command lines of a page: in backticks, or between fences.
std::vector<std::vector<std::string>> lines_of_page(const std::string& page) {
  std::vector<std::vector<std::string>> lines;
  bool is_fenced = false;
  std::istringstream text(page);
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("```")) is_fenced = !is_fenced;
    std::istringstream parts(line);
    bool is_code = is_fenced;
    for (std::string part;
         is_fenced ? bool(std::getline(parts, part)) : bool(std::getline(parts, part, '`'));) {
      std::istringstream words(part);
      if (is_code) lines.emplace_back();
      for (std::string word; is_code && words >> word;) {
        if (word == "mosbench" || word == "|" || word == "&&" || word.starts_with('#')) {
          lines.emplace_back();
        } else {
          lines.back().push_back(word);
        }
      }
      is_code = is_fenced || !is_code;
    }
  }
  return lines;
}

/// History tells what was measured then; the reference repeats the help, which is looked at here.
TEST_F(OldWords, AreOnNoPage) {
  const std::filesystem::path source = MOSBENCH_SOURCE_DIR;
  std::vector<std::filesystem::path> pages = {source / "README.md", source / "CONTRIBUTING.md"};
  for (const char* folder : {"docs", "tests/examples", "results", "eval", "datasets"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / folder)) {
      const std::string path = entry.path().string();
      const bool is_left_out = path.find("docs/history") != std::string::npos ||
                               path.find("docs/reference") != std::string::npos;
      const auto ending = entry.path().extension();
      if (!is_left_out && (ending == ".md" || ending == ".txt")) pages.push_back(entry.path());
    }
  }
  std::size_t lines = 0;
  for (const std::filesystem::path& page : pages) {
    std::string text = read_file(page);
    if (page.extension() == ".txt") text = "```\n" + text;  // of help
    for (const std::vector<std::string>& words : lines_of_page(text)) {
      if (words.empty() ||
          std::ranges::find(commands(), words.front(), &Command::name) == commands().end())
        continue;
      ++lines;
      const auto now = in_new_words(words, [](const auto&, const auto&) { return true; });
      EXPECT_EQ(fmt::format("{}", fmt::join(now, " ")), fmt::format("{}", fmt::join(words, " ")))
          << page;
    }
  }
  EXPECT_GT(lines, 100U);
}

TEST_F(OldWords, TakeNoUnknownFlagForOne) {
  const cli::Answer answer = ask("stats SIM --predictions OUT/run --id-map 0:9,1:251");
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, testing::StartsWith("mosbench: --id-map: is no flag of mosbench stats"));
}

TEST_F(OldWords, AreNotInHelp) {
  for (const OldFlag& old : old_flags()) {
    const std::string command = std::string(old.commands.substr(0, old.commands.find(' ')));
    const std::string help = cli::run({command, "--help"}).out;
    EXPECT_EQ(help.find(fmt::format("  {} ", old.flag)), std::string::npos) << old.flag;
  }
  const std::string help = cli::run({"--help"}).out;
  for (const OldCommand& old : old_commands()) {
    if (old.arguments != 0) continue;  // with others it is a command of today
    EXPECT_EQ(help.find(fmt::format("\n  {} ", old.name)), std::string::npos) << old.name;
  }
}

}  // namespace
}  // namespace mosbench
