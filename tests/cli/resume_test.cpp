#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Resume : public testing::Test {
 protected:
  Resume() { cli::write_small_sequence(folder_ / "room", 10); }

  std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--out",
                                      (folder_ / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  fs::path results() const { return folder_ / "out/room"; }

  TempFolder folder_;
};

std::size_t labels_in(const fs::path& folder) {
  std::error_code error;
  std::size_t labels = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".label") ++labels;
  }
  return labels;
}

TEST_F(Resume, AfterKillGivesTheFilesOfAnUndisturbedRun) {
  cli::write_small_sequence(folder_ / "long", 150);
  const std::string input = (folder_ / "long").string();
  const std::vector<std::string> disturbed = {"run", input, "--out", (folder_ / "a").string()};
  ASSERT_EQ(cli::run({"run", input, "--out", (folder_ / "b").string()}).exit_code, 0);

  // Kill it as soon as some labels are written, long before the last.
  const TempFolder streams;
  const pid_t child = cli::start(disturbed, streams.path());
  while (labels_in(folder_ / "a/long.partial/labels") < 5 &&
         waitpid(child, nullptr, WNOHANG) == 0) {
    std::this_thread::yield();
  }
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(cli::wait_for(child), 128 + SIGKILL);
  ASSERT_FALSE(fs::exists(folder_ / "a/long"));
  ASSERT_TRUE(fs::exists(folder_ / "a/long.partial"));

  const cli::Answer again = cli::run(disturbed);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(cli::contents(folder_ / "a"), cli::contents(folder_ / "b"));
}

TEST_F(Resume, SkipsWhatIsFinished) {
  const cli::Answer first = cli::run(command());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string written = read_file(results() / "result.json");
  folder_.write("out/room.partial/labels/000001.label", "left by a killed run");
  const cli::Answer second = cli::run(command());
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.err, HasSubstr("room: finished by an earlier run, kept"));
  EXPECT_FALSE(fs::exists(folder_ / "out/room.partial"));
  EXPECT_EQ(read_file(results() / "result.json"), written);
  EXPECT_EQ(second.out, first.out);
}

TEST_F(Resume, ScoresConfidencesOfAFinishedRunWhereItsDataAreNow) {
  const std::vector<std::string> scored = command({"--write", "scores"});
  const cli::Answer first = cli::run(scored);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  ASSERT_THAT(first.out, HasSubstr("average precision"));
  fs::create_directories(folder_ / "new");
  fs::rename(folder_ / "room", folder_ / "new/room");
  const cli::Answer second = cli::run({"run", (folder_ / "new/room").string(), "--out",
                                       (folder_ / "out").string(), "--write", "scores"});
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.err, HasSubstr("room: finished by an earlier run, kept"));
  EXPECT_THAT(second.out, HasSubstr("average precision"));
}

TEST_F(Resume, RunsASequenceAnewWhenALabelFileIsMissingOrCut) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const auto whole = cli::contents(results());
  fs::remove(results() / "labels/000003.label");
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  EXPECT_EQ(cli::contents(results()), whole);
  fs::resize_file(results() / "labels/000003.label", 8);
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  EXPECT_EQ(cli::contents(results()), whole);
}

TEST_F(Resume, RunsASequenceAnewWhenScoresAreAskedForAndNotThere) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  ASSERT_EQ(cli::run(command({"--scores"})).exit_code, 0);
  const auto whole = cli::contents(results());
  ASSERT_EQ(labels_in(results() / "labels"), 10U);
  ASSERT_TRUE(fs::exists(results() / "scores/000009.score"));
  // Asking for less keeps what is there.
  const cli::Answer less = cli::run(command());
  EXPECT_THAT(less.err, HasSubstr("finished by an earlier run, kept"));
  EXPECT_EQ(cli::contents(results()), whole);
  fs::resize_file(results() / "scores/000004.score", 8);
  ASSERT_EQ(cli::run(command({"--scores"})).exit_code, 0);
  EXPECT_EQ(cli::contents(results()), whole);
  folder_.write("out/room/scores/000999.score", "stale");
  const cli::Answer refused = cli::run(command({"--scores"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("000999.score: belongs to no scan"));
}

TEST_F(Resume, RunsASequenceAnewWhenReasonsAreCutOrGone) {
  const auto plus = command({"--scores", "--method", "hmm-mos-plus"});
  ASSERT_EQ(cli::run(plus).exit_code, 0);
  const auto whole = cli::contents(results());
  fs::resize_file(results() / "reasons/000004.reason", 8);
  ASSERT_EQ(cli::run(plus).exit_code, 0);
  EXPECT_EQ(cli::contents(results()), whole);
  fs::remove_all(results() / "reasons");
  ASSERT_EQ(cli::run(plus).exit_code, 0);
  EXPECT_EQ(cli::contents(results()), whole);
  folder_.write("out/room/reasons/000999.reason", "stale");
  const cli::Answer refused = cli::run(plus);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("000999.reason: belongs to no scan"));
}

TEST_F(Resume, RefusesResultsOfAnotherConfigurationAndNamesTheDifference) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const auto before = cli::contents(folder_ / "out");
  const cli::Answer refused = cli::run(command({"--set", "max_range_m=30"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("settings/max_range_m is 50.0 there and 30.0 now"));
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(cli::contents(folder_ / "out"), before);
  const cli::Answer replaced = cli::run(command({"--set", "max_range_m=30", "--overwrite"}));
  ASSERT_EQ(replaced.exit_code, 0) << replaced.err;
  EXPECT_EQ(cli::timeless_result(results()).at("settings").at("max_range_m"), 30.0);
}

/// What `stats` or `bless` of the folder could not tell apart later.
TEST_F(Resume, RefusesAFolderWithResultsOfAnotherDataSetOrSetting) {
  for (const char* sequence : {"a/sequences/00", "a/sequences/01", "b/sequences/02"}) {
    cli::write_small_sequence(folder_ / sequence, 6);
  }
  const auto run = [this](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run", (folder_ / input).string(), "--out",
                                      (folder_ / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  ASSERT_EQ(run("a", {"--sequences", "00"}).exit_code, 0);
  const auto before = cli::contents(folder_ / "out");
  const cli::Answer other = run("b", {});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("out/00/result.json"));
  EXPECT_THAT(other.err, HasSubstr("data set is " + (folder_ / "a").string() + " there and " +
                                   (folder_ / "b").string() + " now"));
  for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--overwrite"}}) {
    std::vector<std::string> flags = {"--sequences", "01", "--set", "max_range_m=30"};
    flags.insert(flags.end(), extra.begin(), extra.end());
    const cli::Answer setting = run("a", flags);
    EXPECT_EQ(setting.exit_code, 2);
    EXPECT_THAT(setting.err, HasSubstr("settings/max_range_m is 50.0 there and 30.0 now"));
  }
  EXPECT_EQ(cli::contents(folder_ / "out"), before);
  // Sequences of one data set, however they are named.
  EXPECT_EQ(run("a/sequences/01", {}).exit_code, 0);
  EXPECT_EQ(run("a/sequences/00/", {}).exit_code, 0);
  const cli::Answer all = run("a", {});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("01: finished by an earlier run, kept"));
}

TEST_F(Resume, PassesOverResultsThatAreNotOursAndFollowsLinks) {
  cli::write_small_sequence(folder_ / "disk1/first", 6);
  cli::write_small_sequence(folder_ / "disk2/second", 6);
  fs::create_directories(folder_ / "kitti/sequences");
  fs::create_directory_symlink(folder_ / "disk1/first", folder_ / "kitti/sequences/00");
  fs::create_directory_symlink(folder_ / "disk2/second", folder_ / "kitti/sequences/01");
  write_file_atomic(folder_ / "out/other_tool/result.json", "{\"accuracy\": 1}");
  for (const char* name : {"00", "01"}) {
    const cli::Answer answer = cli::run({"run", (folder_ / "kitti/sequences" / name).string(),
                                         "--out", (folder_ / "out").string()});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
  }
}

TEST_F(Resume, RefusesOtherInputButNotTouchedInput) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const fs::path scan = folder_ / "room/velodyne/000004.bin";
  fs::last_write_time(scan, fs::last_write_time(scan) + std::chrono::hours(1));
  EXPECT_EQ(cli::run(command()).exit_code, 0);
  std::vector<Point> points = read_bin(scan);
  points.front().x += 0.01F;
  write_bin(scan, points);
  const cli::Answer refused = cli::run(command());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("results of other input files"));
}

/// As `cp -p`, rsync and archives leave it.
TEST_F(Resume, RefusesOtherInputOfTheSameSizeAndTime) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const fs::path scan = folder_ / "room/velodyne/000004.bin";
  const auto time = fs::last_write_time(scan);
  const auto size = fs::file_size(scan);
  std::vector<Point> points = read_bin(scan);
  points.front().x += 0.01F;
  write_bin(scan, points);
  fs::last_write_time(scan, time);
  ASSERT_EQ(fs::file_size(scan), size);
  const cli::Answer refused = cli::run(command());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("results of other input files"));
}

TEST_F(Resume, ReadsAllInputAgainToVerifyOrWithoutAStampThatFits) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const fs::path file = results() / "result.json";
  const auto content = nlohmann::ordered_json::parse(read_file(file));
  // As older programs wrote it: the frames are the same.
  auto older = content;
  older["places"]["file_stamp"] = "0123456789abcdef0123456789abcdef";
  write_file_atomic(file, older.dump());
  EXPECT_THAT(cli::run(command()).err, HasSubstr("finished by an earlier run, kept"));
  auto other = content;
  other["provenance"]["fingerprint"] = "0123456789abcdef0123456789abcdef";
  write_file_atomic(file, other.dump());
  EXPECT_EQ(cli::run(command()).exit_code, 0);
  const cli::Answer refused = cli::run(command({"--verify"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("results of other input files"));
}

TEST_F(Resume, RefusesOtherSplits) {
  fs::rename(folder_ / "room", folder_ / "Velodyne");
  folder_.write("test.txt", "6\n7\n");
  const std::vector<std::string> words = {"run",     folder_.path(), "--dataset",
                                          "helimos", "--protocol",   "helimos-test",
                                          "--out",   folder_ / "out"};
  const cli::Answer first = cli::run(words);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(cli::run(words).err, HasSubstr("kept"));
  folder_.write("test.txt", "4\n5\n");
  const cli::Answer refused = cli::run(words);
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("results of other split files than Velodyne has now"));
}

TEST_F(Resume, RefusesLabelsThatWereChangedAfterTheRun) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  const fs::path file = results() / "labels/000007.label";
  std::vector<std::uint32_t> labels = read_labels(file, cli::kPointsPerScan);
  // As many move as before.
  std::reverse(labels.begin(), labels.end());
  ASSERT_NE(labels, read_labels(file, cli::kPointsPerScan));
  write_labels(file, labels);
  const cli::Answer refused = cli::run(command());
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("000007.label: was changed after the run"));
  // A result of an older program has no hash of its labels.
  std::ranges::fill(labels, kMovingLabel);
  write_labels(file, labels);
  auto content = nlohmann::ordered_json::parse(read_file(results() / "result.json"));
  for (auto& scan : content["scans"]) scan.erase("label_hash");
  write_file_atomic(results() / "result.json", content.dump());
  EXPECT_THAT(cli::run(command()).err, HasSubstr("000007.label: was changed after the run"));
  EXPECT_EQ(cli::run(command({"--overwrite"})).exit_code, 0);
}

TEST_F(Resume, RefusesALabelFileWithoutScan) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  folder_.write("out/room/labels/000999.label", "stale");
  const cli::Answer refused = cli::run(command());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("000999.label: belongs to no scan"));
  ASSERT_EQ(cli::run(command({"--overwrite"})).exit_code, 0);
  EXPECT_EQ(labels_in(results() / "labels"), 10U);
}

TEST_F(Resume, NeverReplacesAFolderThatIsNotItsOwn) {
  // --out beside the data: results would land on the truth.
  const auto before = cli::contents(folder_ / "room");
  for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--overwrite"}}) {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--out",
                                      folder_.path().string()};
    words.insert(words.end(), extra.begin(), extra.end());
    const cli::Answer refused = cli::run(words);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("was not written by mosbench run"));
  }
  EXPECT_EQ(cli::contents(folder_ / "room"), before);
}

TEST_F(Resume, RefusesADamagedResultFile) {
  ASSERT_EQ(cli::run(command()).exit_code, 0);
  fs::resize_file(results() / "result.json", 100);
  const cli::Answer refused = cli::run(command());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("result.json"));
  EXPECT_EQ(cli::run(command({"--overwrite"})).exit_code, 0);
}

TEST_F(Resume, LetsOnlyOneRunWriteToAFolder) {
  cli::write_small_sequence(folder_ / "long", 150);
  const std::vector<std::string> words = {"run", (folder_ / "long").string(), "--out",
                                          (folder_ / "out").string()};
  const TempFolder streams;
  const pid_t child = cli::start(words, streams.path());
  while (!fs::exists(folder_ / "out/long.partial") && waitpid(child, nullptr, WNOHANG) == 0) {
    std::this_thread::yield();
  }
  const cli::Answer second = cli::run(words);
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(cli::wait_for(child), 128 + SIGKILL);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("another mosbench is writing there"));
}

}  // namespace
}  // namespace mosbench
