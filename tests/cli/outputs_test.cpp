#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <future>
#include <iterator>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_writer.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr const char* kOldPage = "<!doctype html>mosbench";

/// Ends a program that waits for what never comes.
void give_a_minute() { alarm(60); }

class Outputs : public testing::Test {
 protected:
  Outputs() {
    cli::write_small_sequence(folder_ / "room", 6);
    const cli::Answer run = cli::run({"run", room(), "--out", (folder_ / "out").string()});
    if (run.exit_code != 0) throw std::runtime_error(run.err);
  }
  std::string room() const { return (folder_ / "room").string(); }
  std::vector<std::string> report_to(const std::string& file) const {
    return {"report", (folder_ / "out").string(), "--scans", "none", "-o", file};
  }
  fs::path fifo(const char* name) const {
    const fs::path file = folder_ / name;
    fs::create_directories(file.parent_path());
    fs::remove(file);
    EXPECT_EQ(mkfifo(file.c_str(), 0600), 0);
    return file;
  }

  TempFolder folder_;
};

TEST_F(Outputs, FollowALinkAndKeepIt) {
  folder_.write("disk/page.html", kOldPage);
  fs::create_symlink("disk/page.html", folder_ / "link.html");
  const cli::Answer answer = cli::run(report_to(folder_ / "link.html"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.html"));
  EXPECT_THAT(read_file(folder_ / "disk/page.html"), StartsWith("<!"));
}

TEST_F(Outputs, ReplaceThoseOfBeforeAndNothingElse) {
  const std::string run = (folder_ / "out").string(), result = run + "/room/result.json";
  const auto to = [&](std::vector<std::string> words, const std::string& file) {
    words.insert(words.end(), {"-o", file});
    return cli::run(words);
  };
  const std::vector<std::string> rank = {"rank", run}, compare = {"compare", run, run},
                                 curve = {"render", run, "--scans", "3"};
  folder_.write("page.png", "mine");
  folder_.write("page.html", "<html>mine</html>");
  folder_.write("settings.json", "{\"max_range_m\": 30}");
  folder_.write("job.yaml", "name: job\n");
  folder_.write("binary.csv", std::string("a\0b", 3));
  const std::string before = read_file(result);
  for (const auto& [words, file] : {std::pair{rank, result},
                                    {compare, result},
                                    {rank, folder_ / "settings.json"},
                                    {report_to("x"), folder_ / "page.html"},
                                    {rank, folder_ / "page.html"},
                                    {rank, folder_ / "job.yaml"},
                                    {compare, folder_ / "job.yaml"},
                                    {rank, folder_ / "binary.csv"},
                                    {curve, folder_ / "page.png"}}) {
    const std::string held = read_file(file);
    std::vector<std::string> line = words;
    if (line.front() == "report") line.resize(4);
    const cli::Answer refused = to(line, file);
    EXPECT_EQ(refused.exit_code, 2) << file;
    const bool is_known = file.ends_with(".html") || file.ends_with(".json");
    EXPECT_THAT(refused.err, AllOf(HasSubstr(file + ": is "), HasSubstr(", expected another")));
    EXPECT_EQ(refused.err.find("that mosbench wrote") != std::string::npos,
              (is_known && file != result) || file.ends_with(".yaml"))
        << refused.err;
    EXPECT_EQ(read_file(file), held);
  }
  EXPECT_EQ(read_file(result), before);
  for (const char* record : {"products.json", "simulated.json", "best.preset.json", "poses.txt"}) {
    folder_.write(record, "{}\n");
    EXPECT_THAT(to(rank, folder_ / record).err,
                HasSubstr(std::string(record) + ": is a name under which mosbench keeps"));
    EXPECT_EQ(read_file(folder_ / record), "{}\n");
  }
  for (const char* ending : {".txt", ".json", ".csv", ".tex", ".md", ".html", ".xml", ""}) {
    for (int round = 0; round < 2; ++round) {
      const std::string file = folder_ / ("gate" + std::string(ending));
      EXPECT_EQ(to(compare, file).exit_code, 0) << ending;
      const bool has_ranks = std::string_view(ending) != ".xml";
      EXPECT_TRUE(!has_ranks || to(rank, file + "2" + ending).exit_code == 0) << ending;
    }
  }
}

TEST_F(Outputs, GoIntoAFifoThatStaysOne) {
  const fs::path pipe = fifo("pipe");
  auto reader = std::async(std::launch::async, [&pipe] {
    std::ifstream in(pipe);
    return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  });
  const cli::Answer answer =
      cli::run({"profile", room(), "--scans", "2", "--json", pipe.string()}, give_a_minute);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(reader.get(), StartsWith("{"));
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(Outputs, NamedAsDashAreAloneOnStdout) {
  const cli::Answer page = cli::run(report_to("-"));
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(page.out, AllOf(StartsWith("<!"), Not(HasSubstr("report of 1 result"))));
  EXPECT_THAT(page.err, HasSubstr("report of 1 result in -"));
  const cli::Answer profile = cli::run({"profile", room(), "--scans", "2", "--json", "-"});
  ASSERT_EQ(profile.exit_code, 0) << profile.err;
  EXPECT_TRUE(nlohmann::json::accept(profile.out));
  const cli::Answer picture =
      cli::run({"render", (folder_ / "out").string(), "--scan", "2", "--size", "200", "-o", "-"});
  ASSERT_EQ(picture.exit_code, 0) << picture.err;
  EXPECT_THAT(picture.out, StartsWith("\x89PNG"));
  const cli::Answer poses = cli::run({"odometry", room(), "-o", "-"});
  EXPECT_EQ(std::ranges::count(poses.out, '\n'), 6) << poses.err;
  EXPECT_FALSE(fs::exists("-"));
  EXPECT_EQ(cli::run({"profile", room(), "--json", "-", "--out", "-"}).exit_code, 2);
}

TEST_F(Outputs, ThatLeadToStdoutAreWrittenThroughIt) {
  // As /dev/stdout does, under a name that may be lost.
  fs::create_symlink("/proc/self/fd/1", folder_ / "out.json");
  const cli::Answer answer =
      cli::run({"profile", room(), "--scans", "2", "--json", (folder_ / "out.json").string()});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_TRUE(fs::is_symlink(folder_ / "out.json"));
  EXPECT_THAT(answer.out, AllOf(StartsWith("{"), HasSubstr("\n}\n")));
  EXPECT_GT(answer.out.size(), answer.out.find("\n}\n") + 10) << "the answer follows";
}

TEST_F(Outputs, ThatNobodyReadsToTheirEndEndQuietly) {
  const auto close_reader = [] {
    int ends[2];
    if (pipe(ends) != 0) _exit(126);
    close(ends[0]);
    dup2(ends[1], STDOUT_FILENO);
  };
  for (const auto& words : {std::vector<std::string>{"list"}, report_to("-")}) {
    const cli::Answer answer = cli::run(words, close_reader);
    EXPECT_EQ(answer.exit_code, 0);
    EXPECT_THAT(answer.err, Not(HasSubstr("mosbench:")));
  }
}

TEST_F(Outputs, StopAtAFileSizeLimitWithoutALeftover) {
  const fs::path file = folder_.write("pages/page.html", kOldPage);
  const cli::Answer answer = cli::run(report_to(file), [] {
    const struct rlimit small { 10'000, 10'000 };
    setrlimit(RLIMIT_FSIZE, &small);
  });
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("page.html: cannot be written (File too large)"));
  EXPECT_EQ(read_file(file), kOldPage);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1);
}

TEST_F(Outputs, AreNotMadeOfWhatNeverEnds) {
  const std::string pipe = fifo("pipe").string();
  const std::string out = (folder_ / "new").string();
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"run", room(), "--config", pipe, "--out", out},
                                             {"run", room(), "--poses", pipe, "--out", out},
                                             {"table", "I", "--published", pipe},
                                             {"score", room(), "--predictions", pipe},
                                             {"stats", pipe}}) {
    const cli::Answer answer = cli::run(words, give_a_minute);
    EXPECT_THAT(answer.exit_code, testing::AnyOf(2, 3)) << words.at(0) << answer.err;
    EXPECT_THAT(answer.err, HasSubstr("pipe")) << words.at(0);
  }
  for (const char* file : {"poses.txt", "calib.txt", "times.txt", "velodyne/000003.bin"}) {
    fs::copy(room(), folder_ / "copy", fs::copy_options::recursive);
    fifo((std::string("copy/") + file).c_str());
    const cli::Answer answer =
        cli::run({"run", (folder_ / "copy").string(), "--out", out}, give_a_minute);
    EXPECT_EQ(answer.exit_code, 3) << file;
    EXPECT_THAT(answer.err, HasSubstr(file));
    fs::remove_all(folder_ / "copy");
  }
}

TEST_F(Outputs, AreRefusedForFoldersGivenAsFilesAndForDeepJson) {
  const std::string out = (folder_ / "new").string();
  const cli::Answer of_folder = cli::run({"run", room(), "--config", room(), "--out", out});
  EXPECT_EQ(of_folder.exit_code, 2);
  EXPECT_THAT(of_folder.err, HasSubstr("room: is a folder"));
  constexpr std::size_t kLevels = 300'000;
  const std::string deep = "{\"a\":" + std::string(kLevels, '[') + std::string(kLevels, ']') + "}";
  const std::string file = folder_.write("deep/result.json", deep).string();
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"run", room(), "--config", file, "--out", out},
                                             {"simulate", "--layout", "doals", "--scene", file,
                                              "--scans", "2", "--seed", "1", "--out", out},
                                             {"stats", file},
                                             {"report", file, "-o", out, "--scans", "none"},
                                             {"bless", file, out},
                                             {"table", "I", (folder_ / "deep").string()}}) {
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, words.at(0) == "run" ? 2 : 3) << words.at(0);
    EXPECT_THAT(answer.err, HasSubstr("result.json: nests deeper than 64 levels")) << words.at(0);
    EXPECT_FALSE(fs::exists(out)) << words.at(0);
  }
}

TEST_F(Outputs, FailWithAMessageWhenTheMachineHasNoThreadsForThem) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than there is under a limit";
#endif
  const cli::Answer answer =
      cli::run({"run", room(), "--threads", "300", "--out", (folder_ / "new").string()}, [] {
        const struct rlimit small { 1'000'000'000, 1'000'000'000 };
        setrlimit(RLIMIT_AS, &small);
        give_a_minute();
      });
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("the machine gives no more"));
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

TEST_F(Outputs, FailWithAMessageWhenALibraryForBagsFindsNoMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than there is under a limit";
#endif
  if (!writes_bags()) GTEST_SKIP() << "a build without librosbag_storage";
  int failed = 0;
  constexpr rlim_t kTried = 15;
  for (rlim_t limit_mib = 20, tried = 0; limit_mib <= 100 && tried < kTried; ++limit_mib) {
    const auto limit = [&] {
      const struct rlimit small { limit_mib << 20, limit_mib << 20 };
      setrlimit(RLIMIT_AS, &small);
    };
    // Its libraries need memory of their own before it begins.
    if (cli::run({"-V"}, limit).exit_code != 0) continue;
    ++tried;
    const cli::Answer answer = cli::run(
        {"convert", room(), "--layout", "doals-bag", "--out", (folder_ / "new").string()}, limit);
    fs::remove_all(folder_ / "new");
    EXPECT_THAT(answer.exit_code, testing::AnyOf(0, 3)) << limit_mib << " " << answer.err;
    failed += answer.exit_code == 3 ? 1 : 0;
  }
  EXPECT_GT(failed, 0);
}

}  // namespace
}  // namespace mosbench
