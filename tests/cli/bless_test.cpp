#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

using Files = std::vector<std::pair<std::string, std::string>>;

/// Two runs of two sequences each, of which one is the same, and a baseline of the first.
class Bless : public testing::Test {
 protected:
  Bless() {
    for (const char* name : {"00", "01", "02"}) {
      cli::write_small_sequence(folder_ / "data/sequences" / name, 6);
    }
    run("first", "00,01");
    run("second", "01,02");
    expect_blessed("first");
    folder_.write("baseline/README.md", "why these numbers");
  }
  void run(const char* out, const char* sequences) const {
    const cli::Answer answer = cli::run({"run", (folder_ / "data").string(), "--sequences",
                                         sequences, "--out", (folder_ / out).string()});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  fs::path baseline() const { return folder_ / "baseline"; }
  std::vector<std::string> command(const std::string& newer) const {
    return {"bless", (folder_ / newer).string(), baseline().string(), "--even-if"};
  }
  void expect_blessed(const std::string& newer) const {
    const cli::Answer answer = cli::run(command(newer));
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  /// Paths of all that lies beside the baseline and is named like it.
  std::vector<std::string> beside() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename();
      if (name.starts_with("baseline")) names.push_back(name);
    }
    return names;
  }
  std::vector<fs::path> sequences() const {
    std::vector<fs::path> names;
    for (const char* name : {"00", "01", "02"}) {
      if (fs::exists(baseline() / name / "result.json")) names.emplace_back(name);
    }
    return names;
  }

  TempFolder folder_;
};

TEST_F(Bless, ReplacesAllSequencesAndKeepsOtherFiles) {
  ASSERT_THAT(sequences(), ElementsAre("00", "01"));
  expect_blessed("second");
  EXPECT_THAT(sequences(), ElementsAre("01", "02"));
  EXPECT_EQ(read_file(baseline() / "README.md"), "why these numbers");
  EXPECT_THAT(beside(), ElementsAre("baseline"));
}

TEST_F(Bless, KeepsTheOldBaselineWhereTheNewOneHasNoRoom) {
  const Files before = cli::contents(baseline());
  const cli::Answer answer = cli::run(command("second"), [] {
    const struct rlimit small { 1000, 1000 };
    setrlimit(RLIMIT_FSIZE, &small);
  });
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_EQ(cli::contents(baseline()), before);
  EXPECT_THAT(beside(), ElementsAre("baseline"));
}

TEST_F(Bless, LeavesTheOldOrTheNewBaselineWheneverItIsKilled) {
  const std::string old_bytes = read_file(baseline() / "00/result.json");
  expect_blessed("second");
  const Files fresh = cli::contents(baseline());
  const std::string fresh_bytes = read_file(baseline() / "02/result.json");
  int killed = 0;
  for (int round = 0; round < 16; ++round) {
    expect_blessed("first");
    ASSERT_THAT(sequences(), ElementsAre("00", "01"));
    const TempFolder streams;
    const pid_t child = cli::start(command("second"), streams.path());
    std::this_thread::sleep_for(std::chrono::milliseconds(4 * round));
    kill(child, SIGKILL);
    killed += cli::wait_for(child) == 128 + SIGKILL ? 1 : 0;
    const auto left = sequences();
    ASSERT_THAT(left, testing::AnyOf(ElementsAre("00", "01"), ElementsAre("01", "02")));
    EXPECT_EQ(read_file(baseline() / (left.front() == "00" ? "00" : "02") / "result.json"),
              left.front() == "00" ? old_bytes : fresh_bytes);
    EXPECT_EQ(read_file(baseline() / "README.md"), "why these numbers");
    EXPECT_EQ(cli::run({"stats", baseline().string()}).exit_code, 0) << "round " << round;
    expect_blessed("second");
    ASSERT_EQ(cli::contents(baseline()), fresh) << "round " << round;
  }
  EXPECT_GT(killed, 0);
  EXPECT_THAT(beside(), ElementsAre("baseline"));
}

TEST_F(Bless, KeepsWhyAndWhenInWhatChanges) {
  const auto accepted = [&](const char* sequence) {
    const auto json = nlohmann::json::parse(read_file(baseline() / sequence / "result.json"));
    return json.value("accepted", nlohmann::json());
  };
  const auto accept = [&](const std::string& newer, const std::string& flag,
                          const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"compare", baseline().string(), (folder_ / newer).string(),
                                      flag, "--even-if"};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  const cli::Answer answer = accept("second", "--accept=more \"rooms\"");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr(": more \"rooms\"\n"));
  EXPECT_THAT(answer.out, HasSubstr("MOS gate: pass")) << "sequence by sequence";
  EXPECT_EQ(accepted("02").at("why"), "more \"rooms\"");
  EXPECT_THAT(accepted("02").at("on").get<std::string>(), testing::MatchesRegex("20..-..-.."));
  EXPECT_EQ(accepted("01").at("why"), "more \"rooms\"") << "its cost changed";
  EXPECT_THAT(cli::run({"compare", baseline().string(), (folder_ / "second").string()}).out,
              HasSubstr(": more \"rooms\"\n"));
  const Files before = cli::contents(baseline());
  const cli::Answer again = accept("second", "--accept=again");
  ASSERT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.out, HasSubstr("already: nothing changed, and no reason is kept\n"));
  EXPECT_EQ(cli::contents(baseline()), before) << "nothing changed";
  const cli::Answer empty = accept("second", "--accept=");
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("--accept=: is empty, expected a value"));

  // Sequence 00 alone; 01 and 02 stay, although the new run has no 02.
  const cli::Answer one = accept("first", "--accept", {"--sequences", "00"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(sequences(), ElementsAre("00", "01", "02"));
  EXPECT_EQ(accepted("02").at("why"), "more \"rooms\"");
  EXPECT_TRUE(accepted("00").is_null());
  EXPECT_EQ(accept("first", "--accept", {"--sequences", "07"}).exit_code, 3);
  const cli::Answer coarse =
      cli::run({"run", (folder_ / "data").string(), "--sequences", "00", "--out",
                (folder_ / "coarse").string(), "--set", "voxel_size_m=0.4"});
  ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
  EXPECT_THAT(accept("coarse", "--accept", {"--sequences", "00"}).err,
              HasSubstr("keeps sequences of another kind"));
  EXPECT_EQ(cli::run({"compare", baseline().string(), (folder_ / "first").string(), "--sequences",
                      "00,01"})
                .exit_code,
            0);
}

TEST_F(Bless, RefusesAFolderWithLabelsOfARun) {
  const Files before = cli::contents(folder_ / "first");
  const cli::Answer answer = cli::run(
      {"compare", (folder_ / "first").string(), (folder_ / "second").string(), "--accept"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("first/01/labels: is of the run there, and would stay beside "
                                    "other numbers, expected a folder of accepted results alone"));
  EXPECT_EQ(cli::contents(folder_ / "first"), before);
}

TEST_F(Bless, KeepsTheCostThatAGateComparesWith) {
  const auto edit_in = [&](const fs::path& folder, auto&& change) {
    for (const char* name : {"00", "01"}) {
      const fs::path file = folder / name / "result.json";
      auto json = nlohmann::ordered_json::parse(read_file(file));
      change(json);
      write_file_atomic(file, json.dump());
    }
  };
  const auto edit = [&](auto&& change) { edit_in(baseline(), change); };
  const auto compare = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"compare", baseline().string(), (folder_ / "first").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  EXPECT_EQ(compare({"--max-cost", "cpu=0,memory=0,bytes=0"}).exit_code, 0) << "the same run";
  edit([](nlohmann::ordered_json& json) {
    nlohmann::ordered_json& cost = json.at("cost");
    EXPECT_GT(cost.at("calibration_ms").get<double>(), 0.0);
    EXPECT_GT(cost.at("bytes_written").get<int>(), 6 * 4 * 100);
    ASSERT_GT(cost.at("core_ms_per_scan").get<double>(), 0.0);
    EXPECT_EQ(cost.at("what_written").size(), 1U);
    EXPECT_TRUE(cost.at("machine").contains("processor"));
    cost["core_ms_per_scan"] = 1000;
    json.at("settings").erase("min_otsu_score");  // a release before had none
  });
  EXPECT_EQ(compare({"--max-cost", "cpu=50"}).exit_code, 0) << "faster";
  edit_in(folder_ / "first",
          [](nlohmann::ordered_json& json) { json.at("timing")["core_s"] = 6 * 2.0; });
  const cli::Answer warned = compare({});
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_THAT(warned.out, testing::ContainsRegex("CPU ms per scan .* warning"));
  EXPECT_THAT(warned.out, HasSubstr("settings that the baseline does not have: min_otsu_score: 3"));
  const cli::Answer failed = compare({"--max-cost", "cpu=50", "--as", "github"});
  EXPECT_EQ(failed.exit_code, 1) << failed.err;
  EXPECT_THAT(failed.out, HasSubstr("::error title=CPU ms per scan grew::"));
  EXPECT_EQ(compare({"--max-cost", "gpu=3"}).exit_code, 2);
  edit([](nlohmann::ordered_json& json) { json.erase("cost"); });
  EXPECT_THAT(compare({"--max-cost", "cpu=50"}).err,
              HasSubstr("does not tell its CPU ms per scan"));
}

TEST_F(Bless, TakesOneMethodOfSeveral) {
  const auto run_both = [&](const char* out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run",      (folder_ / "data").string(),
                                      "--method", "yoon,hmm-mos",
                                      "--out",    (folder_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    const cli::Answer answer = cli::run(words);
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  };
  run_both("both", {"--sequences", "00"});
  const auto asked = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"compare", (folder_ / "base").string(),
                                      (folder_ / "both").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  EXPECT_EQ(asked({"--accept"}).exit_code, 3) << "two runs";
  for (const char* method : {"yoon", "hmm-mos"}) {
    const cli::Answer answer = asked({"--accept=first", "--method", method});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_TRUE(fs::exists(folder_ / "base" / method / "00/result.json"));
    EXPECT_EQ(asked({"--method", method}).exit_code, 0);
  }
  EXPECT_THAT(asked({"--method", "octomap"}).err, HasSubstr("holds no results of octomap"));
}

TEST_F(Bless, RefusesFoldersThatOverlap) {
  fs::create_directory_symlink(folder_ / "first", folder_ / "link");
  const Files before = cli::contents(folder_ / "first");
  const std::vector<std::pair<std::string, std::string>> overlapping = {
      {"first", "first"}, {"first", "."},      {"first", "first/00"},
      {"first", "link"},  {"link", "first/x"}, {"first/00/result.json", "first"}};
  for (const auto& [newer, into] : overlapping) {
    const cli::Answer answer =
        cli::run({"bless", (folder_ / newer).string(), (folder_ / into).string(), "--even-if"});
    EXPECT_EQ(answer.exit_code, 2) << newer << " " << into;
    EXPECT_THAT(answer.err, HasSubstr("overlaps with the results"));
    EXPECT_EQ(cli::contents(folder_ / "first"), before);
  }
  fs::create_directories(folder_ / "linked");
  fs::create_directory_symlink(folder_ / "first/00", folder_ / "linked/00");
  const cli::Answer answer =
      cli::run({"bless", (folder_ / "first").string(), (folder_ / "linked").string()});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("leads out of the baseline"));
  EXPECT_EQ(cli::contents(folder_ / "first"), before);
}

TEST_F(Bless, WaitsForNoOtherWriter) {
  const Files before = cli::contents(baseline());
  const FolderLock lock(baseline());
  const cli::Answer answer = cli::run(command("second"));
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("baseline: another mosbench is writing there"));
  EXPECT_EQ(cli::contents(baseline()), before);
}

}  // namespace
}  // namespace mosbench
