#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Answers as a shell prints them. A scan of the small sequence has 8640 points, its labels 34,576
// bytes with index and count.
static_assert(cli::kPointsPerScan == 8640);
const std::string kHello = "head -c 40 > /dev/null; ";
const std::string kReady = kHello + R"(printf 'MOSready\10\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0'; )";
const std::string kScan = "head -c 138376 > /dev/null; ";
const std::string kLabel = R"(printf 'MOSlabel\20\207\0\0\0\0\0\0'; )";
const std::string kFirst = R"(printf '\0\0\0\0\0\0\0\0\300\41\0\0\0\0\0\0'; )";
const std::string kLabels =
    "head -c 34560 /dev/zero | tr '\\0' '\\11' | sed 's/\\t\\t\\t\\t/\\t\\x00\\x00\\x00/g'; ";

/// Whether a `sleep` of so many seconds runs on the machine.
bool sleeps(const std::string& seconds) {
  const std::string sleeping = std::string("sleep") + '\0' + seconds + '\0';
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "cmdline", std::ios::binary);
    const std::string line{std::istreambuf_iterator<char>(file), {}};
    if (line == sleeping) return true;
  }
  return false;
}

/// The same, but a process that was killed has a moment to go.
bool stays_asleep(const std::string& seconds) {
  for (int i = 0; i < 500 && sleeps(seconds); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return sleeps(seconds);
}

class Exec : public testing::Test {
 protected:
  Exec() { cli::write_small_sequence(folder_ / "room", 4); }

  std::vector<std::string> command(const std::string& program, const std::string& out = "out",
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run",   folder_ / "room", "--method", "exec:" + program,
                                      "--out", folder_ / out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::string client() { return std::string(MOSBENCH_BINARY_DIR) + "/examples/exec_client"; }

  TempFolder folder_;
};

TEST_F(Exec, TakesTheLabelsOfAProgramAndKeepsThem) {
  const cli::Answer answer = cli::run(command(client(), "out", {"--threads", "1", "--scores"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto result = cli::timeless_result(folder_ / "out/room");
  EXPECT_EQ(result.at("method").at("name"), "exec:" + client());
  EXPECT_EQ(result.at("method").at("kind"), "exec");
  EXPECT_EQ(result.at("settings"), (nlohmann::json{{"timeout_s", 60.0}}));
  EXPECT_GT(result.at("summary").at("tp").get<int>(), 50) << "the box moves into new voxels";
  EXPECT_THAT(cli::run(command(client())).err, HasSubstr("finished by an earlier run, kept"));
  EXPECT_THAT(cli::run(command(client(), "out", {"--set", "timeout_s=90"})).err,
              HasSubstr("kept; if the program has changed, --overwrite runs it again"));
  const cli::Answer other = cli::run(command("true; " + client()));
  EXPECT_EQ(other.exit_code, 2) << "another program is another method";
  const cli::Answer threads =
      cli::run(command(client(), "threads", {"--threads", "3", "--scores"}));
  ASSERT_EQ(threads.exit_code, 0) << threads.err;
  EXPECT_EQ(cli::contents(folder_ / "threads"), cli::contents(folder_ / "out"));
}

TEST_F(Exec, IsMeasuredByTheCpuOfItsProcesses) {
  const auto cost_of = [&](const char* out, const std::string& before) {
    const cli::Answer answer = cli::run(command(before + client(), out));
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    const auto json = nlohmann::json::parse(read_file(folder_ / out / "room/result.json"));
    return std::pair(json.at("timing").at("program_cpu_s").get<double>(),
                     json.at("timing").at("core_s").get<double>());
  };
  const auto [sleeping_s, slept_s] = cost_of("sleeps", "sleep 2; ");
  EXPECT_GE(slept_s, 2.0);
  EXPECT_LT(sleeping_s, slept_s - 1.5);
  const auto [busy_s, taken_s] =
      cost_of("works", "i=0; while [ $i -lt 1000000 ]; do i=$((i+1)); done; ");
  EXPECT_GT(busy_s, sleeping_s + 0.1);
  const cli::Answer profile =
      cli::run({"profile", folder_ / "room", "--method", "exec:" + client()});
  EXPECT_THAT(profile.out, HasSubstr("CPU is without the program, which took 0."));
  const cli::Answer accepted =
      cli::run({"compare", folder_ / "base", folder_ / "sleeps", "--accept"});
  ASSERT_EQ(accepted.exit_code, 0) << accepted.err;
  const auto base = nlohmann::json::parse(read_file(folder_ / "base/room/result.json"));
  EXPECT_NEAR(base.at("cost").at("core_ms_per_scan").get<double>(), 1e3 * sleeping_s / 4, 1e-6);
}

TEST_F(Exec, IsRunAgainWhenItsFilesHaveChanged) {
  const std::string script = folder_.write("ours.sh", client() + "\n").string();
  const std::vector<std::string> words = command("sh '" + script + "'");
  ASSERT_EQ(cli::run(words).exit_code, 0);
  EXPECT_THAT(cli::run(words).err, HasSubstr("finished by an earlier run, kept"));
  folder_.write("ours.sh", "# better\n" + client() + "\n");
  const cli::Answer again = cli::run(words);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("room: the program has changed, it is run again"));
  EXPECT_THAT(cli::run(words).err, HasSubstr("finished by an earlier run, kept"));
  // What an earlier mosbench wrote does not tell.
  const auto file = folder_ / "out/room/result.json";
  auto json = nlohmann::ordered_json::parse(read_file(file));
  json.erase("program");
  write_file_atomic(file, json.dump());
  EXPECT_THAT(cli::run(words).err, HasSubstr("finished by an earlier run, kept"));
}

TEST_F(Exec, IsRefusedByTablesWhenItsFilesHaveChangedSince) {
  const fs::path script = folder_.write("ours.sh", client() + "\n");
  const fs::path weights = folder_.write("weights.pt", "1");
  const std::string out = (folder_ / "out").string();
  const auto words =
      command("sh '" + script.string() + "' # behind a comment: " + weights.string());
  for (const fs::path& file : {script, weights}) {
    ASSERT_EQ(cli::run(words).exit_code, 0);
    const std::string before = read_file(file);
    write_file_atomic(file, before + "\n");
    for (const std::vector<std::string>& table : {std::vector<std::string>{"stats", out},
                                                  {"rank", out},
                                                  {"table", "I", out},
                                                  {"stats", out, "--by", "range"},
                                                  {"compare", out, out}}) {
      const cli::Answer refused = cli::run(table);
      EXPECT_EQ(refused.exit_code, 3) << table.front();
      EXPECT_THAT(refused.err, HasSubstr("stale: its program has changed since, " + file.string()));
      if (table.front() == "table") continue;
      std::vector<std::string> allowed = table;
      allowed.insert(allowed.end(), {"--allow-stale", "--as", "csv"});
      const cli::Answer marked = cli::run(allowed);
      EXPECT_EQ(marked.exit_code, 0) << marked.err;
      EXPECT_THAT(marked.out, HasSubstr("STALE: " + file.string())) << table.front();
    }
    EXPECT_THAT(cli::run(words).err, HasSubstr("the program has changed, it is run again"));
    EXPECT_EQ(cli::run({"stats", out}).exit_code, 0);
  }
  fs::remove(weights);  // as on another machine
  const cli::Answer gone = cli::run({"stats", out});
  EXPECT_EQ(gone.exit_code, 0);
  EXPECT_THAT(gone.out, HasSubstr("nobody can tell whether it is stale: " + weights.string()));
}

TEST_F(Exec, IsComparedWithABaselineThatIsNeverStale) {
  const fs::path script = folder_.write("ours.sh", client() + "\n");
  const std::string out = folder_ / "out", base = folder_ / "base";
  const auto words = command("sh '" + script.string() + "'");
  ASSERT_EQ(cli::run(words).exit_code, 0);
  ASSERT_EQ(cli::run({"compare", base, out, "--accept"}).exit_code, 0);
  write_file_atomic(script, read_file(script) + "\n");
  ASSERT_EQ(cli::run(words).exit_code, 0);
  const cli::Answer changed = cli::run({"compare", base, out});
  EXPECT_EQ(changed.exit_code, 0) << changed.err;
  EXPECT_THAT(changed.out, Not(HasSubstr("STALE")));
  fs::rename(script, folder_ / "elsewhere.sh");
  EXPECT_THAT(cli::run({"stats", base}).out, Not(HasSubstr("nobody can tell")));
}

TEST_F(Exec, IsStaleWhereItsLabelsAreScored) {
  const fs::path script = folder_.write("ours.sh", client() + "\n");
  const std::string out = folder_ / "out", room = folder_ / "room", scores = folder_ / "scores";
  const std::vector<std::string> score = {"score", room, "--predictions", out};
  std::vector<std::string> keep = score;
  keep.insert(keep.end(), {"--out", scores});
  ASSERT_EQ(cli::run(command("sh '" + script.string() + "'")).exit_code, 0);
  EXPECT_THAT(cli::run(keep).out, Not(HasSubstr("STALE")));
  EXPECT_THAT(cli::run({"rank", scores}).out, HasSubstr("exec:sh"));  // not "unnamed"
  // Labels of others are not the run's, wherever they lie.
  fs::copy(folder_ / "out/room/labels", folder_ / "out/room/mine");
  EXPECT_THAT(cli::run({"score", room, "--predictions", folder_ / "out/room/mine", "--out",
                        folder_ / "others"})
                  .out,
              HasSubstr("IoU"));
  EXPECT_THAT(cli::run({"rank", folder_ / "others"}).out, HasSubstr("unnamed"));
  write_file_atomic(script, read_file(script) + "\n");
  const std::string stale = "STALE: " + script.string() + " has changed since";
  EXPECT_EQ(cli::run({"rank", scores}).exit_code, 3);
  for (const char* as : {"text", "json", "csv"}) {
    for (std::vector<std::string> words :
         {score, {"stats", room, "--by", "range", "--predictions", out}}) {
      words.insert(words.end(), {"--as", as});
      EXPECT_THAT(cli::run(words).out, HasSubstr(stale)) << words.front() << " as " << as;
    }
  }
  keep.emplace_back("--overwrite");
  ASSERT_EQ(cli::run(keep).exit_code, 0);
  EXPECT_EQ(cli::run({"rank", scores}).exit_code, 3);
}

TEST_F(Exec, IsRunAgainWhereTheFilesOfItsResultHaveChangedButNotThoseOfNow) {
  const auto from = [&](const char* place) {
    return cli::run(command("sh ours.sh"), [&] { fs::current_path(folder_ / place); });
  };
  for (const char* script : {"a/ours.sh", "b/ours.sh"}) folder_.write(script, client() + "\n");
  ASSERT_EQ(from("a").exit_code, 0);
  EXPECT_THAT(from("b").err, HasSubstr("finished by an earlier run, kept"));
  folder_.write("a/ours.sh", "# better\n" + client() + "\n");
  EXPECT_EQ(cli::run({"stats", folder_ / "out"}).exit_code, 3);
  EXPECT_THAT(from("b").err, HasSubstr("room: the program has changed, it is run again"));
  EXPECT_EQ(cli::run({"stats", folder_ / "out"}).exit_code, 0);
}

TEST_F(Exec, KeepsTheResultsOfEachStateOfAProgramInAStudy) {
  folder_.write("ours.sh", client() + "\n");
  folder_.write("s.yaml",
                "name: s\nprotocol: semantickitti-mos\n"
                "data: {name: room, path: room, dataset: semantickitti}\n"
                "methods: [{name: ours, method: \"exec:sh ours.sh\"}]\n");
  const auto there = [&] { fs::current_path(folder_.path()); };
  const std::vector<std::string> run = {"run", "s.yaml", "--out", "out", "--threads", "1"};
  ASSERT_EQ(cli::run(run, there).exit_code, 0);
  folder_.write("ours.sh", "# better\n" + client() + "\n");
  EXPECT_EQ(cli::run({"stats", folder_ / "out/cells"}).exit_code, 3);
  const cli::Answer again = cli::run(run, there);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const auto rank = cli::run({"rank", "s.yaml", "--out", "out"}, there);
  EXPECT_EQ(rank.exit_code, 0) << rank.err;
  EXPECT_THAT(rank.out, Not(HasSubstr("STALE")));
  // A program that fails now must not cost what an earlier one found.
  folder_.write("ours.sh", "exit 3\n");
  EXPECT_NE(cli::run(run, there).exit_code, 0);
  folder_.write("ours.sh", "# better\n" + client() + "\n");
  EXPECT_EQ(cli::run({"rank", "s.yaml", "--out", "out"}, there).exit_code, 0);
}

/// Runs and ranks a study of one program where its files lie.
struct ProgramStudy {
  ProgramStudy(const TempFolder& place, const std::string& program) : folder(place) {
    folder.write("s.yaml",
                 "name: s\nprotocol: semantickitti-mos\n"
                 "data: {name: room, path: room, dataset: semantickitti}\n"
                 "methods: [{name: ours, method: \"exec:" +
                     program + "\"}]\n");
  }
  cli::Answer answer(const std::string& command) const {
    std::vector<std::string> words = {command, "s.yaml", "--out", "out"};
    if (command == "run") words.insert(words.end(), {"--threads", "1"});
    return cli::run(words, [&] { fs::current_path(folder.path()); });
  }
  const TempFolder& folder;
};

TEST_F(Exec, ReadsResultsWhereFilesOfItsCommandAreGone) {
  folder_.write("weights.pt", "weights");
  folder_.write("ours.sh", client() + "\n");
  const ProgramStudy study(folder_, "sh ours.sh # reads weights.pt");
  ASSERT_EQ(study.answer("run").exit_code, 0);
  fs::remove(folder_ / "weights.pt");
  fs::remove(folder_ / "ours.sh");
  const cli::Answer rank = study.answer("rank");
  EXPECT_EQ(rank.exit_code, 0) << rank.err;
  EXPECT_THAT(rank.out, AllOf(HasSubstr("1 of 1 cell is done"),
                              HasSubstr("nobody can tell whether it is stale: ")));
  EXPECT_THAT(study.answer("run").err, HasSubstr("names weights.pt behind its #"));
}

TEST_F(Exec, SaysInAStudyThatItChangesAFileOfItsCommand) {
  folder_.write("log.txt", "");
  const ProgramStudy study(folder_, client() + " 2>> log.txt; echo ran >> log.txt # log.txt");
  const cli::Answer run = study.answer("run");
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_THAT(run.out, AllOf(HasSubstr("STALE: "), HasSubstr("log.txt has changed since"),
                             Not(HasSubstr("INCOMPLETE"))));
  EXPECT_THAT(run.err, HasSubstr("ours: a file that its command names has changed during the run"));
}

TEST_F(Exec, TakesAFileOfItsCommandThatItRemovesInAStudyForAChange) {
  folder_.write("weights.pt", "");
  const ProgramStudy study(folder_, client() + "; rm weights.pt # weights.pt");
  const cli::Answer run = study.answer("run");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("ours"));
  EXPECT_THAT(run.err, HasSubstr("ours: a file that its command names has changed during the run"));
}

TEST_F(Exec, IsRefusedAtOnceWhereItNamesAFileThatIsNotThere) {
  for (const std::string name : {"weights.pt", "net/weights.onnx"}) {
    const cli::Answer answer = cli::run(command(client() + " # reads " + name));
    EXPECT_EQ(answer.exit_code, 2) << name;
    EXPECT_THAT(answer.err, HasSubstr("names " + name + " behind its #, which does not exist"));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
  EXPECT_EQ(
      cli::run(command(client() + " # version 1.2, see https://a.b/c, e.g. on/off")).exit_code, 0);
  folder_.write("w.pt", "1");
  fs::remove_all(folder_ / "out");
  const std::string weights = (folder_ / "w.pt").string();
  EXPECT_EQ(cli::run(command(client() + " # (" + weights + "), trained")).exit_code, 0);
}

TEST_F(Exec, FailsWhenItsFolderIsRemovedMeanwhile) {
  // The answers to the start and to two scans have 24 + 2 * (16 + 34,576) bytes.
  const std::string partial = (folder_ / "out/room.partial").string();
  const std::string then =
      "dd bs=4 count=17302 iflag=fullblock status=none; sleep 0.3; rm -r '" + partial + "'; cat";
  const cli::Answer answer = cli::run(command(client() + " | (" + then + ")"));
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("2 of 4 label files were removed during the run"));
  EXPECT_FALSE(fs::exists(folder_ / "out/room"));
}

TEST_F(Exec, FailsWhenAFinishedSequenceIsRemovedMeanwhile) {
  for (const char* name : {"a", "b"}) cli::write_small_sequence(folder_.path() / "set" / name, 3);
  const std::string finished = (folder_ / "out/a").string();
  const cli::Answer answer = cli::run({"run", folder_ / "set", "--out", folder_ / "out", "--method",
                                       "exec:rm -rf '" + finished + "'; " + client()});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("out/a/result.json: was removed during the run"));
}

TEST_F(Exec, PassesOnWhatTheProgramSaysOnStderr) {
  EXPECT_THAT(cli::run(command("echo weights are read >&2; " + client())).err,
              HasSubstr("weights are read\n"));
}

TEST_F(Exec, RemarksOnAProgramThatFailsAfterItsLastScan) {
  const cli::Answer answer = cli::run(command(client() + "; exit 5"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("the program ended with exit code 5 after its last scan"));
}

struct Fault {
  std::string name, program, error;
  std::vector<std::string> more = {};
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class ExecFault : public Exec, public testing::WithParamInterface<Fault> {};

INSTANTIATE_TEST_SUITE_P(
    Programs, ExecFault,
    testing::Values(
        Fault{"ends", "exit 3", "the program ended with exit code 3 after 0 of 16 bytes"},
        Fault{"isNotThere", "/nowhere/client", "ended with exit code 127"},
        Fault{"crashes", "kill -SEGV $$", "was ended by signal 11 after 0 of 16 bytes"},
        Fault{"hangs",
              "sleep 1000",
              "gave 0 of 16 bytes within 0.3 s, and left 0 bytes of its "
              "input unread",
              {"--set", "timeout_s=0.3"}},
        Fault{"leavesItsGroup",
              "exec python3 -c 'import os, time; os.setpgid(0, os.getpgid(os.getppid())); "
              "time.sleep(1000)'",
              "gave 0 of 16 bytes within 0.3 s",
              {"--set", "timeout_s=0.3"}},
        Fault{"doesNotRead",
              kReady + "sleep 1000",
              "of its input unread",
              {"--set", "timeout_s=0.3"}},
        Fault{"closesItsStdout",
              kReady + "exec >&-; sleep 1000",
              "the program closed its stdout after 0 of 16 bytes",
              {"--set", "timeout_s=0.3"}},
        Fault{"printsText", "echo Loading the weights of a large network",
              "the program answers \"Loading \", expected a message MOSready on stdout, and other "
              "text on stderr"},
        Fault{"floods", "yes", "the program answers"},
        Fault{"hasAnotherVersion",
              kHello + R"(printf 'MOSready\10\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0'; cat > /dev/null)",
              "the program speaks version 2, expected version 1"},
        Fault{"hasNoScores",
              kReady + "cat > /dev/null",
              "the program gives no scores, expected scores, or a run without --write scores",
              {"--scores"}},
        Fault{"announcesTooMuch",
              kReady + kScan + R"(printf 'MOSlabel\377\377\377\377\377\377\377\177'; cat)",
              "the program announces 9223372036854775807 bytes in MOSlabel, expected 34576 bytes"},
        Fault{"writesTooLittle", kReady + kScan + kLabel + kFirst + "head -c 100 /dev/zero",
              "the program ended with exit code 0 after 116 of 34576 bytes"},
        Fault{"writesTooMuch",
              kReady + kScan + kLabel + kFirst + kLabels + "yes | head -c 9000; cat > /dev/null",
              "the program "},
        Fault{"labelsAnotherScan",
              kReady + kScan + kLabel + R"(printf '\2'; head -c 34575 /dev/zero; cat > /dev/null)",
              "the program labels 0 points of scan 2, expected the 8640 points of scan 0"},
        Fault{"givesAnotherLabel",
              kReady + kScan + kLabel + kFirst + "head -c 34560 /dev/zero; cat > /dev/null",
              "the program gives point 0 the label 0, expected 9 (static) or 251 (moving)"}),
    [](const auto& fault) { return fault.param.name; });

TEST_P(ExecFault, IsAnErrorThatNamesTheScan) {
  const cli::Answer answer = cli::run(command(GetParam().program, "out", GetParam().more));
  EXPECT_EQ(answer.exit_code, 3) << answer.out;
  EXPECT_THAT(answer.err, HasSubstr(GetParam().error));
  const bool is_later = GetParam().name == "writesTooMuch";
  EXPECT_THAT(answer.err, testing::ContainsRegex(is_later ? "00000[01].bin: " : "000000.bin: "));
  EXPECT_FALSE(fs::exists(folder_ / "out/room"));
  EXPECT_FALSE(fs::exists(folder_ / "out/room.partial"));
}

/// Five minutes and what no other test sleeps for.
std::string own_seconds() { return "300." + std::to_string(1000000 + getpid()); }

TEST_F(Exec, LeavesNoProcessBehind) {
  const std::string seconds = own_seconds();
  ASSERT_EQ(cli::run(command("sleep " + seconds + " & " + client())).exit_code, 0);
  EXPECT_FALSE(stays_asleep(seconds)) << "a process of the program after a good run";
  const std::string hanging = "sleep " + seconds + " & sleep " + seconds + "; :";
  ASSERT_EQ(cli::run(command(hanging, "late", {"--set", "timeout_s=0.2"})).exit_code, 3);
  EXPECT_FALSE(stays_asleep(seconds)) << "processes of a program that hangs";
}

TEST_F(Exec, LeavesNoProcessBehindWhenItIsKilledItself) {
  const std::string seconds = own_seconds();
  for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {
    const TempFolder streams;
    const pid_t mosbench = cli::start(command("sleep " + seconds + "; :"), streams.path());
    for (int i = 0; i < 1000 && !sleeps(seconds); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(sleeps(seconds));
    ASSERT_EQ(kill(mosbench, signal), 0);
    ASSERT_EQ(cli::wait_for(mosbench), 128 + signal);
    EXPECT_FALSE(stays_asleep(seconds)) << signal;
  }
}

TEST_F(Exec, IsRefusedWithoutAProgram) {
  const cli::Answer answer = cli::run(command(""));
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("names no program, expected exec:COMMAND"));
}

}  // namespace
}  // namespace mosbench
