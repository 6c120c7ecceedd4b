#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Score : public testing::Test {
 protected:
  Score() {
    cli::write_small_sequence(folder_ / "room", 8);
    const cli::Answer run = cli::run(
        {"run", (folder_ / "room").string(), "--out", (folder_ / "out").string(), "--json"});
    if (run.exit_code != 0) throw std::runtime_error(run.err);
    run_ = nlohmann::json::parse(run.out);
  }
  cli::Answer score(const fs::path& predictions, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"score", (folder_ / "room").string(), "--predictions",
                                      predictions.string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }
  fs::path labels() const { return folder_ / "out/room/labels"; }

  TempFolder folder_;
  nlohmann::json run_;
};

TEST_F(Score, GivesTheNumbersOfTheRunForItsLabelsWhereverTheyLie) {
  fs::create_directories(folder_ / "api/sequences/room");
  fs::copy(labels(), folder_ / "api/sequences/room/predictions", fs::copy_options::recursive);
  for (const fs::path& predictions :
       {folder_ / "out", folder_ / "out/room", labels(), folder_ / "api"}) {
    const cli::Answer answer = score(predictions, {"--json"});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_EQ(nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary"),
              run_.at("sequences").at(0).at("summary"))
        << predictions;
  }
}

TEST_F(Score, ReadsScansOfFiveColumnsWhereToldSo) {
  for (std::size_t k = 0; k < 8; ++k) {
    const fs::path file = folder_ / "room/velodyne" / (cli::stem(k) + ".bin");
    std::string wide;
    for (const Point& point : read_bin(file)) {
      wide.append(format_bin({&point, 1})).append(sizeof(float), '\0');  // the ring
    }
    write_file_atomic(file, wide);
  }
  const cli::Answer told = score(folder_ / "out", {"--bin-columns", "5", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(nlohmann::json::parse(told.out).at("sequences").at(0).at("summary"),
            run_.at("sequences").at(0).at("summary"));
  EXPECT_EQ(score(folder_ / "out").exit_code, 3);
  const cli::Answer broken_down =
      cli::run({"breakdown", (folder_ / "room").string(), "--predictions",
                (folder_ / "out").string(), "--bin-columns", "5"});
  EXPECT_EQ(broken_down.exit_code, 0) << broken_down.err;
}

TEST_F(Score, PrintsATableOfTheChosenProtocol) {
  const cli::Answer answer =
      score(folder_ / "out", {"--protocol", "doals-dynablox", "--range", "0.5,20"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("protocol doals-dynablox"));
  EXPECT_THAT(answer.out, HasSubstr("room"));
}

TEST_F(Score, GivesOneToThePerfectPrediction) {
  fs::copy(folder_ / "room/labels", folder_ / "perfect");
  const cli::Answer answer = score(folder_ / "perfect", {"--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary").at("iou"), 1.0);
}

TEST_F(Score, RefusesMissingExtraAndWronglySizedFiles) {
  const fs::path label = labels() / "000005.label";
  fs::rename(label, folder_ / "aside");
  EXPECT_THAT(score(folder_ / "out").err, HasSubstr("000005.label: is not there"));
  EXPECT_EQ(score(folder_ / "out").exit_code, 3);
  fs::rename(folder_ / "aside", label);

  fs::copy_file(label, labels() / "000105.label");
  const cli::Answer extra = score(folder_ / "out");
  EXPECT_EQ(extra.exit_code, 3);
  EXPECT_THAT(extra.err, HasSubstr("000105.label: belongs to no scan"));
  fs::remove(labels() / "000105.label");

  fs::resize_file(label, fs::file_size(label) - 4);
  const cli::Answer shorter = score(folder_ / "out");
  EXPECT_EQ(shorter.exit_code, 3);
  EXPECT_THAT(shorter.err, HasSubstr("000005.label: has 34556 bytes"));
}

TEST_F(Score, NeedsPredictionsForLabelledScansOnly) {
  for (const char* stem : {"000000", "000001"}) {
    fs::remove(folder_ / "room/labels" / (std::string(stem) + ".label"));
    fs::remove(labels() / (std::string(stem) + ".label"));
  }
  const cli::Answer answer = score(folder_ / "out", {"--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(
      nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary").at("labelled_scans"),
      6);
}

TEST(ScoreHelimos, CountsTheScansOfTheProtocolsSplitAsTheRunDoes) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "helimos/Velodyne", 8);
  write_file_atomic(folder / "helimos/test.txt", "6\n7\n");
  write_file_atomic(folder / "helimos/train.txt", "1\n");
  const cli::Answer run = cli::run({"run", (folder / "helimos").string(), "--protocol",
                                    "helimos-test", "--out", (folder / "out").string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto row = nlohmann::json::parse(run.out).at("sequences").at(0);
  EXPECT_EQ(row.at("split"), "test");
  EXPECT_EQ(row.at("summary").at("labelled_scans"), 2);
  const auto result = cli::timeless_result(folder / "out/Velodyne");
  EXPECT_EQ(result.at("summary_split"), "test");
  EXPECT_EQ(nlohmann::json(result.at("summary")), row.at("summary"));

  const fs::path labels = folder / "out/Velodyne/labels";
  fs::remove(labels / "000001.label");  // of another split: not needed
  const auto score = [&](const std::string& protocol) {
    return cli::run({"score", (folder / "helimos").string(), "--predictions",
                     (folder / "out").string(), "--json", "--protocol", protocol});
  };
  const cli::Answer test = score("helimos-test");
  ASSERT_EQ(test.exit_code, 0) << test.err;
  EXPECT_EQ(nlohmann::json::parse(test.out).at("sequences").at(0).at("summary"), row.at("summary"));
  EXPECT_THAT(score("helimos-all").err, HasSubstr("000001.label: is not there"));
}

TEST(ScoreHelimos, RefusesAnotherSplitThanTheProtocolsAndMarksThatOfAnOpenOne) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "helimos/Velodyne", 8);
  write_file_atomic(folder / "helimos/test.txt", "6\n7\n");
  write_file_atomic(folder / "helimos/val.txt", "2\n3\n4\n");
  fs::create_directories(folder / "mine");
  fs::copy(folder / "helimos/Velodyne/labels", folder / "mine/Velodyne");
  const auto score = [&](const std::string& protocol, const std::string& split) {
    return cli::run({"score", folder / "helimos", "--predictions", folder / "mine", "--protocol",
                     protocol, "--split", split, "--out", folder / "out"});
  };
  for (const char* protocol : {"helimos-test", "mapmos"}) {
    const cli::Answer refused = score(protocol, "val");
    EXPECT_EQ(refused.exit_code, 2) << protocol;
    EXPECT_THAT(refused.err, HasSubstr("--split: 'val' is not the split of protocol")) << protocol;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  const cli::Answer val = score("helimos-all", "val");
  ASSERT_EQ(val.exit_code, 0) << val.err;
  const std::string mark = "only the scans of split val";
  EXPECT_THAT(val.out, HasSubstr(mark));
  EXPECT_EQ(cli::timeless_result(folder / "out/Velodyne").at("summary_split"), "val");
  EXPECT_THAT(cli::run({"stats", folder / "out"}).out, HasSubstr(mark));
  EXPECT_THAT(cli::run({"table", "III", folder / "out", "--format", "csv"}).out, HasSubstr(mark));
  fs::remove_all(folder / "out");
  const cli::Answer test = score("helimos-test", "test");
  ASSERT_EQ(test.exit_code, 0) << test.err;
  EXPECT_EQ(test.out.find("only the scans"), std::string::npos);
}

TEST_F(Score, RefusesTheTruthAsPrediction) {
  const cli::Answer answer = score(folder_ / "room");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("holds the truth of sequence room"));
}

TEST_F(Score, RefusesWhatCannotBeScored) {
  EXPECT_EQ(score(folder_ / "nowhere").exit_code, 3);
  EXPECT_EQ(score(folder_ / "out", {"--split", "nowhere"}).exit_code, 2);
  EXPECT_EQ(score(folder_ / "out", {"--protocol", "nothing"}).exit_code, 2);
  EXPECT_EQ(score(folder_ / "out", {"--range", "1,2"}).exit_code, 2);
  fs::remove_all(folder_ / "room/labels");
  const cli::Answer no_truth = score(folder_ / "out");
  EXPECT_EQ(no_truth.exit_code, 3);
  EXPECT_THAT(no_truth.err, HasSubstr("no scan to score has truth"));
}

TEST_F(Score, NeverWritesOverARunOrBesideAnotherWriter) {
  const auto before = cli::contents(folder_ / "out");
  const std::string run = (folder_ / "out").string();
  const cli::Answer refused = score(labels(), {"--out", run});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("was not written by mosbench score"));
  EXPECT_EQ(cli::contents(folder_ / "out"), before);
  fs::rename(labels(), folder_ / "mine");
  EXPECT_EQ(score(folder_ / "mine", {"--out", run}).exit_code, 2) << "nor over its numbers alone";

  const std::string scored = (folder_ / "scored").string();
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(score(folder_ / "mine", {"--out", scored}).exit_code, 0) << again;
  }
  const FolderLock lock(scored);
  const cli::Answer second = score(folder_ / "mine", {"--out", scored});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("another mosbench is writing there"));
}

}  // namespace
}  // namespace mosbench
