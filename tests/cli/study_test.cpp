#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

bool within_10_s(const std::function<bool()>& is_so) {
  for (int i = 0; i < 1000 && !is_so(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return is_so();
}

/// Two small sequences, two methods, one disturbance.
class Studies : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"00", "01"}) {
      cli::write_small_sequence(folder_.path() / "data/sequences" / name, 6);
    }
    folder_.write("s.yaml", R"(name: s
protocol: sipailou
data: {name: small, path: data, dataset: semantickitti}
methods:
  - {method: hmm-mos, set: {voxel_size_m: 0.4}}
  - underwood
disturb: {kind: range_noise_m, strengths: [0.05]}
)");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  cli::Answer study(const std::string& action, std::vector<std::string> words = {}) const {
    std::vector<std::string> all = {action == "table" ? "rank" : "run", path("s.yaml")};
    if (action == "plan") all.emplace_back("--dry-run");
    if (action == "cell") {
      const auto end = std::ranges::find_if(words, [](auto& word) { return word[0] == '-'; });
      const std::vector<std::string> keys(words.begin(), end);
      all.push_back(fmt::format("--only={}", fmt::join(keys, ",")));
      words.erase(words.begin(), end);
    }
    all.insert(all.end(), words.begin(), words.end());
    if (std::find(words.begin(), words.end(), "--out") == words.end()) {
      all.insert(all.end(), {"--out", path("out")});
    }
    return cli::run(all, go_there());
  }
  /// Commands of programs may name files of the folder.
  std::function<void()> go_there() const {
    return [there = folder_.path()] { std::filesystem::current_path(there); };
  }
  std::vector<std::string> keys() const {
    const auto plan = ordered_json::parse(study("plan", {"--json"}).out);
    std::vector<std::string> keys;
    for (const auto& cell : plan.at("cells")) keys.push_back(cell.at("key"));
    return keys;
  }
  std::size_t cells_in(const std::string& out) const {
    const auto files = std::filesystem::directory_iterator(folder_ / out / "cells");
    return static_cast<std::size_t>(std::count_if(begin(files), end(files), [](const auto& entry) {
      return !entry.path().filename().string().starts_with('.');
    }));
  }
  ordered_json record(const std::string& out, const std::string& key) const {
    return cli::timeless_result(folder_.path() / out / "cells" / key);
  }

  TempFolder folder_;
};

TEST_F(Studies, AreComputedCellByCellAndGathered) {
  ASSERT_EQ(keys().size(), 8u);
  EXPECT_EQ(study("table").exit_code, 1);
  const cli::Answer first = study("cell", keys());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out.find("kept"), std::string::npos);
  const cli::Answer again = study("cell", keys());
  EXPECT_EQ(again.out.find("computed"), std::string::npos);
  const cli::Answer table = study("table");
  EXPECT_EQ(table.exit_code, 0) << table.out;
  EXPECT_THAT(table.out, HasSubstr("8 of 8 cells are done"));
  // A cell's numbers are those of the same run.
  const cli::Answer run =
      cli::run({"run", path("data"), "--dataset", "semantickitti", "--sequences", "00",
                "--protocol", "sipailou", "--set", "voxel_size_m=0.4", "--out", path("run")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ordered_json cell = record("out", keys().front());
  const ordered_json result = cli::timeless_result(folder_ / "run/00");
  EXPECT_EQ(cell.at("summary"), result.at("summary"));
  EXPECT_EQ(cell.at("provenance").at("fingerprint"), result.at("provenance").at("fingerprint"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/scratch"));
  for (const char* format : {"csv", "latex", "json", "html"}) {
    EXPECT_EQ(study("table", {"--as", format}).exit_code, 0) << format;
  }
  EXPECT_THAT(study("table", {"--as", "csv"}).out, testing::StartsWith("key,data,group,sequence,"));
}

TEST_F(Studies, AreRunInThisProcessAndReadByOtherCommands) {
  const cli::Answer run = study("run", {"--threads", "2"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("8 of 8 cells are done"));
  EXPECT_THAT(study("run").err, HasSubstr("nothing is to be computed"));
  const std::string plain = path("out/cells/" + keys()[0]), noisy = path("out/cells/" + keys()[1]);
  const cli::Answer rank = cli::run({"rank", path("out")});
  EXPECT_EQ(rank.exit_code, 0) << rank.err;
  EXPECT_THAT(rank.out, AllOf(HasSubstr("HMM-MOS"), HasSubstr("Underwood")));
  EXPECT_EQ(cli::run({"stats", plain}).exit_code, 0);
  EXPECT_EQ(cli::run({"compare", plain, plain}).exit_code, 0);
  const cli::Answer compared = cli::run({"compare", plain, noisy});
  EXPECT_THAT(compared.out + compared.err, HasSubstr("fingerprints of the scans differ"));
  EXPECT_EQ(cli::run({"report", plain, "--scans", "none", "-o", path("r.html")}).exit_code, 0);
}

TEST_F(Studies, GoOnWhereTheirProcessWasKilled) {
  const TempFolder streams;
  const pid_t killed = cli::start({"run", path("s.yaml"), "--out", path("out")}, streams.path());
  EXPECT_TRUE(within_10_s(
      [&] { return std::filesystem::exists(folder_ / "out/cells") && cells_in("out") > 1; }));
  kill(killed, SIGKILL);
  cli::wait_for(killed);
  EXPECT_EQ(study("run").exit_code, 0);
  EXPECT_EQ(cells_in("out"), 8U);
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out/cells")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
  }
}

TEST_F(Studies, SayThatRecordsOfAnEarlierVersionAreNotUsed) {
  folder_.write("out/cells/0123.json", "{}");
  const cli::Answer plan = study("plan");
  EXPECT_EQ(plan.exit_code, 0);
  EXPECT_THAT(plan.err, HasSubstr("1 record is of an earlier mosbench, not used"));
}

TEST_F(Studies, OfACopyOfTheDataHaveTheSameKeys) {
  const std::vector<std::string> before = keys();
  std::filesystem::rename(folder_ / "data", folder_ / "moved");
  std::filesystem::copy(folder_ / "moved", folder_ / "data",
                        std::filesystem::copy_options::recursive);
  EXPECT_EQ(keys(), before);
  write_file_atomic(folder_ / "data/sequences/01/poses.txt",
                    read_file(folder_ / "data/sequences/01/poses.txt") + " ");
  const std::vector<std::string> after = keys();
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 4, after.begin()));
  for (std::size_t i = 4; i < 8; ++i) EXPECT_NE(before[i], after[i]);
}

TEST_F(Studies, GoOnWhereOneSequenceIsBad) {
  write_file_atomic(folder_ / "data/sequences/01/velodyne/000003.bin", "odd");
  const cli::Answer cells = study("cell", keys());
  EXPECT_EQ(cells.exit_code, 1);
  const cli::Answer table = study("table");
  EXPECT_EQ(table.exit_code, 1);
  EXPECT_THAT(table.out, HasSubstr("4 of 8 cells are done"));
  EXPECT_THAT(table.out, HasSubstr("small 01, hmm-mos and 3 more cells: "));
  EXPECT_THAT(table.out, HasSubstr("000003.bin"));
  cli::write_small_sequence(folder_ / "data/sequences/01", 6);
  EXPECT_EQ(study("cell", keys()).exit_code, 0);
  EXPECT_EQ(study("table").exit_code, 0);
}

TEST_F(Studies, SpeakOfOneCellInTheSingular) {
  folder_.write("s.yaml", R"(name: s
data:
  - {name: whole, path: data, dataset: semantickitti, sequences: ["00"]}
methods: [underwood]
)");
  EXPECT_THAT(study("table", {"-o", path("table.txt")}).out,
              HasSubstr("; INCOMPLETE: 1 cell is missing"));
  ASSERT_EQ(study("cell", keys()).exit_code, 0);
  EXPECT_THAT(study("table").out, HasSubstr("1 of 1 cell is done; it took "));
}

TEST_F(Studies, GoOnWhereASequenceLacksWhatReadingNeeds) {
  folder_.write("s.yaml", R"(name: s
protocol: sipailou
data:
  - {name: whole, path: data, dataset: semantickitti, sequences: ["00"]}
  - {name: timeless, path: data, dataset: semantickitti, sequences: ["01"], reading: {deskew: velocity}}
methods: [underwood]
)");
  const cli::Answer plan = study("plan");
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.err, HasSubstr("timeless 01, underwood: not measured: --deskew"));
  for (const std::string& key : keys()) study("cell", {key});
  const cli::Answer table = study("table");
  EXPECT_EQ(table.exit_code, 1);
  EXPECT_THAT(table.out, HasSubstr("1 of 2 cells are done"));
  EXPECT_THAT(table.out, HasSubstr("timeless 01, underwood: --deskew"));
}

TEST_F(Studies, AreTheSameFromTwoProcessesAtOnce) {
  const std::vector<std::string> all = keys();
  std::vector<std::string> words = {"run", path("s.yaml"), "--only", all[0], "--out", path("two")};
  const TempFolder one, two;
  const auto on_host = [](const char* name) {
    return [name] {  // without the right to it they are on one host
      if (unshare(CLONE_NEWUTS) == 0 && sethostname(name, std::strlen(name)) != 0) _exit(126);
    };
  };
  const pid_t first = cli::start(words, one.path(), on_host("node-1"));
  const pid_t second = cli::start(words, two.path(), on_host("node-2"));
  EXPECT_EQ(cli::wait_for(first), 0);
  EXPECT_EQ(cli::wait_for(second), 0);
  ASSERT_EQ(study("cell", {all[0]}).exit_code, 0);
  EXPECT_EQ(record("two", all[0]), record("out", all[0]));
  EXPECT_EQ(cells_in("two"), 1u);
}

TEST_F(Studies, ComputeAgainWhatAnotherVersionLeft) {
  const std::string key = keys().front();
  ASSERT_EQ(study("cell", {key}).exit_code, 0);
  const auto file = folder_.path() / "out/cells" / key / "result.json";
  auto json = ordered_json::parse(read_file(file));
  json.at("provenance").at("version") = "0.0.1";
  write_file_atomic(file, json.dump());
  EXPECT_THAT(study("plan").out, HasSubstr("1 of another version"));
  const cli::Answer again = study("cell", {key});
  EXPECT_THAT(again.err, HasSubstr("computed by mosbench 0.0.1"));
  EXPECT_THAT(study("plan").out, HasSubstr("0 of another version"));
}

TEST_F(Studies, TellTheHoursOnceTheyAreMeasured) {
  EXPECT_THAT(study("plan").out, HasSubstr("of one core are to be computed"));
  const std::string text = read_file(folder_ / "s.yaml");
  folder_.write("s.yaml", text + "odometry: [none]\nvary: {setting: max_range_m, values: [9]}\n");
  EXPECT_THAT(study("plan").out, HasSubstr("of one core are to be computed"));
  cli::write_small_sequence(folder_.path() / "data/sequences/01", 12);
}

/// A program that waits for a network or a GPU takes a core all the same, and jobs of a cluster
/// that count its CPU time alone would be killed.
TEST_F(Studies, ExpectProgramsAndOdometryToTakeTheirTime) {
  folder_.write("s.yaml", fmt::format(R"(name: s
data: {{name: small, path: data, dataset: semantickitti, sequences: ["00"]}}
methods:
  - {{name: slow, method: "exec:sleep 0.3; {}/examples/exec_client"}}
  - underwood
odometry: [none, simple]
)",
                                      MOSBENCH_BINARY_DIR));
  ASSERT_EQ(study("plan").exit_code, 0);
  std::map<std::string, double> seconds;
  const auto plan = ordered_json::parse(study("plan", {"--json"}).out);
  for (const auto& cell : plan.at("cells")) {
    seconds[cell.at("title")] = cell.at("seconds");
  }
  EXPECT_GT(seconds["small 00, slow"], 0.3);
  EXPECT_GT(seconds["small 00, underwood, poses by simple"], seconds["small 00, underwood"]);
  ASSERT_EQ(study("cell", {keys().front()}).exit_code, 0);
  const auto table = ordered_json::parse(study("table", {"--as", "json"}).out);
  EXPECT_GT(table.at("cpu_s"), 0.3);
  EXPECT_GT(table.at("predicted_cpu_s"), 0.3);
}

TEST_F(Studies, GoOnWhenADiskWasFull) {
  const std::vector<std::string> all = keys();
  const std::vector<std::string> words = {"run",    path("s.yaml"),
                                          "--only", fmt::format("{}", fmt::join(all, ",")),
                                          "--out",  path("out")};
  const cli::Answer full = cli::run(words, [] {
    signal(SIGXFSZ, SIG_IGN);
    const struct rlimit small { 1000, 1000 };
    setrlimit(RLIMIT_FSIZE, &small);
  });
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr(all.front() + "/result.json, as "));
  EXPECT_THAT(full.err, HasSubstr("cannot be written"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out/cells")) << "no half of a record";
  EXPECT_EQ(study("cell", all).exit_code, 0);
}

TEST_F(Studies, AreRunBySnakemakeAndGoOnWhereTheyWereLeft) {
  if (std::system("snakemake --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "snakemake is not installed";
  }
  std::filesystem::create_symlink(MOSBENCH_BINARY_DIR "/examples/exec_client", folder_ / "ours");
  const std::string text = read_file(folder_ / "s.yaml");
  folder_.write("s.yaml", std::string(text).replace(text.find("- underwood"), 11,
                                                    "- {name: ours, method: \"exec:./ours\"}"));
  const std::vector<std::string> all = keys();
  const std::string odd = "out #1: {x}";  // neither YAML nor what Snakemake formats
  ASSERT_EQ(study("cell", {all[2], "--out", path(odd)}).exit_code, 0);
  const TempFolder streams;
  const pid_t killed =
      cli::start({"run", path("s.yaml"), "--on", "local", "--out", path(odd)}, streams.path(), [&] {
        setpgid(0, 0);
        go_there()();
      });
  EXPECT_TRUE(within_10_s([&] { return cells_in(odd) > 1; })) << read_file(streams / "stderr.txt");
  kill(-killed, SIGKILL);  // Snakemake, too
  EXPECT_EQ(cli::wait_for(killed), 128 + SIGKILL);
  const cli::Answer run = study("run", {"--on", "local", "--out", path(odd)});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("8 of 8 cells are done"));
  EXPECT_THAT(study("run", {"--out", path(odd)}).err, HasSubstr("nothing is to be computed"));
  ASSERT_EQ(study("cell", {all[0], "--out", path("alone")}).exit_code, 0);
  EXPECT_EQ(record(odd, all[0]), record("alone", all[0]));
  EXPECT_EQ(study("run", {"--on", path("nothing"), "--out", path("new")}).exit_code, 2);
}

/// Processes whose command names `word`.
std::size_t processes_with(const std::string& word) {
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream command(entry.path() / "cmdline");
    const std::string text{std::istreambuf_iterator<char>(command), {}};
    found += text.find(word) != std::string::npos ? 1U : 0U;
  }
  return found;
}

TEST_F(Studies, LeaveNothingBehindWhenTheyAreStopped) {
  if (std::system("snakemake --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "snakemake is not installed";
  }
  const std::string started = path("started");
  folder_.write("s.yaml", fmt::format(R"(name: s
data: {{name: small, path: data, dataset: semantickitti, sequences: ["00"]}}
methods: {{name: slow, method: "exec:test -d '{0}' && mkdir '{0}-again' && sleep 60; mkdir '{0}'"}}
)",
                                      started));
  // A process that was killed before wrote this.
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  ASSERT_EQ(cli::wait_for(gone), 0);
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string left = fmt::format("out/cells/.{}-{}-00.partial", host.data(), gone);
  folder_.write(left, "half");
  const TempFolder streams;
  const pid_t stopped =
      cli::start({"run", path("s.yaml"), "--on", "local", "--out", path("out")}, streams.path());
  ASSERT_TRUE(within_10_s([&] { return std::filesystem::exists(started + "-again"); }))
      << read_file(streams / "stderr.txt");
  EXPECT_GT(processes_with(path("s.yaml")), 1U) << "the cell, besides the study";
  kill(stopped, SIGTERM);
  EXPECT_EQ(cli::wait_for(stopped), 128 + SIGTERM);
  EXPECT_TRUE(within_10_s([&] { return processes_with(path("s.yaml")) == 0; })) << "its cells";
  EXPECT_TRUE(within_10_s([&] { return processes_with(started) == 0; })) << "the cell's program";
  EXPECT_FALSE(std::filesystem::exists(folder_ / left));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out/cells"));
}

/// A large program that was measured before a small one would have its cells wait for memory.
TEST_F(Studies, ExpectOfEachProgramItsOwnMemory) {
  folder_.write("s.yaml", fmt::format(R"(name: s
data: {{name: small, path: data, dataset: semantickitti, sequences: ["00"]}}
methods:
  - {{name: large, method: "exec:dd if=/dev/zero of=/dev/null bs=200M count=1 2> /dev/null; {0}"}}
  - {{name: small, method: "exec:{0}"}}
)",
                                      MOSBENCH_BINARY_DIR "/examples/exec_client"));
  ASSERT_EQ(study("plan").exit_code, 0);
  const auto costs = ordered_json::parse(read_file(folder_ / "out/costs.json"));
  std::map<std::string, double> mib;
  for (const auto& [name, cost] : costs.items()) {
    if (cost.is_object())
      mib[name.find("/large/") != std::string::npos ? "large" : "small"] = cost.at("memory_mib");
  }
  ASSERT_EQ(mib.size(), 2U);
  EXPECT_GT(mib["large"], 200);
  EXPECT_GT(mib["small"], 1);
  EXPECT_LT(mib["small"], mib["large"] - 100);
}

TEST_F(Studies, RefuseDifferentProtocols) {
  folder_.write("s.yaml", R"(name: s
data:
  - {name: small, path: data, dataset: semantickitti}
  - {name: other, path: data, dataset: sipailou}
methods: underwood
)");
  for (const char* action : {"plan", "run", "table", "cell"}) {
    const bool is_cell = std::string_view(action) == "cell";
    const cli::Answer refused =
        study(action, is_cell ? std::vector<std::string>{"0123"} : std::vector<std::string>{});
    EXPECT_EQ(refused.exit_code, 2) << action;
    EXPECT_THAT(refused.err, HasSubstr("\"small\" by semantickitti-mos; \"other\" by sipailou"));
    EXPECT_THAT(refused.err, HasSubstr("give the key \"protocol:\""));
  }
}

TEST_F(Studies, RefuseWhatIsNotUnderstood) {
  EXPECT_EQ(study("cell", {"0123"}).exit_code, 2);
  EXPECT_EQ(cli::run({"run", path("s.yaml"), "--only"}).exit_code, 2);
  EXPECT_EQ(cli::run({"study", "fly", path("s.yaml")}).exit_code, 2);
  folder_.write("s.yaml", "name: s\ndata: 3\nmethods: [yoon]\n");
  const cli::Answer wrong = study("plan");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("s.yaml:2: "));
  std::string seeds = "[1";
  for (int seed = 2; seed < 60; ++seed) seeds += ", " + std::to_string(seed);
  folder_.write(
      "s.yaml",
      "name: s\ndata: {name: d, path: data, dataset: semantickitti}\nmethods: [underwood]\n"
      "disturb: {kind: range_noise_m, strengths: [1]}\nseeds: " +
          seeds + "]\n");
  const cli::Answer many = study("run");
  EXPECT_EQ(many.exit_code, 2);
  EXPECT_THAT(many.err, HasSubstr("expected --yes"));
}

}  // namespace
}  // namespace mosbench
