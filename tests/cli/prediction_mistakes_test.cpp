// What users give in place of predictions, or say wrongly about them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class PredictionMistakes : public testing::Test {
 protected:
  PredictionMistakes() {
    cli::write_small_sequence(folder_ / "room", 6);
    fs::copy(folder_ / "room/labels", folder_ / "mine");
  }
  cli::Answer score(const fs::path& predictions, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"score", (folder_ / "room").string(), "--predictions",
                                      predictions.string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  /// Writes labels of 6 scans, of which `id_of` gives each, by scan and whether the point moves.
  template <typename IdOf>
  fs::path write_ids(const std::string& name, const IdOf& id_of) const {
    for (std::size_t k = 0; k < 6; ++k) {
      const std::string file = cli::stem(k) + ".label";
      auto labels = read_labels(folder_ / "room/labels" / file, cli::kPointsPerScan);
      for (std::uint32_t& label : labels) label = id_of(k, label == kMovingLabel);
      write_labels(folder_ / name / file, labels);
    }
    return folder_ / name;
  }

  TempFolder folder_;
};

TEST_F(PredictionMistakes, APipeIsRefusedWithoutWaitingForIt) {
  fs::create_directories(folder_ / "pipes");
  for (const char* name : {"indices.csv", "clouds.csv", "room.txt"}) {
    const fs::path pipe = folder_ / "pipes" / name;
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const fs::path& given : {pipe.parent_path(), pipe}) {
      const cli::Answer answer = score(given);
      EXPECT_EQ(answer.exit_code, 3) << given;
      EXPECT_THAT(answer.err, HasSubstr("pipes"));
    }
    fs::remove(pipe);
  }
}

TEST_F(PredictionMistakes, AMaskThatFitsNoScanIsRefusedWithItsCounts) {
  for (const char* mask : {"4,20", "500,600"}) {
    const cli::Answer answer = score(folder_ / "mine", {"--mask", mask});
    EXPECT_EQ(answer.exit_code, 3) << mask;
    EXPECT_THAT(answer.err, HasSubstr(".label: has 8640 labels, expected one for each of the "));
  }
  // Nothing lies outside: the mask is true, and cuts nothing.
  EXPECT_EQ(score(folder_ / "mine", {"--mask", "0,100"}).exit_code, 0);
}

TEST_F(PredictionMistakes, AMaskForAFormatThatCutsNoRangeIsRefused) {
  std::string rows;
  for (int k = 1; k <= 6; ++k) rows += std::to_string(k) + ",5\n";
  const fs::path file = folder_.write("rows.txt", rows);
  ASSERT_EQ(score(file).exit_code, 0);
  const cli::Answer in_rows = score(file, {"--mask", "0,50"});
  EXPECT_EQ(in_rows.exit_code, 2);
  EXPECT_THAT(in_rows.err, HasSubstr("--format label-masked: a range is not for format rows"));
  const cli::Answer told = score(folder_ / "mine", {"--mask", "0,50", "--format", "label"});
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.err, HasSubstr("format label takes nothing behind a colon"));
}

TEST_F(PredictionMistakes, TextsThatHoldNoPredictionsArePassedOver) {
  const fs::path readme = folder_.write("root/README.txt", "Made by hand.\n\nFor a test.\n");
  const cli::Answer root = score(folder_ / "root");
  EXPECT_EQ(root.exit_code, 3);
  EXPECT_THAT(root.err, HasSubstr("root: no predictions for sequence room"));
  EXPECT_THAT(root.err, Not(HasSubstr("README")));
  // Beside predictions it does not hide them.
  std::string rows;
  for (int k = 1; k <= 6; ++k) rows += std::to_string(k) + ",5\n";
  folder_.write("table/rows.txt", rows);
  fs::copy(readme, folder_ / "table/README.txt");
  const cli::Answer table = score(folder_ / "table");
  EXPECT_EQ(table.exit_code, 0) << table.err;
  // Whoever names it is told what is wrong with it.
  EXPECT_THAT(score(readme).err, HasSubstr("README.txt:"));
}

TEST_F(PredictionMistakes, AFaultyFileIsReportedOnce) {
  fs::resize_file(folder_ / "mine/000003.label", 100);
  const cli::Answer answer = score(folder_ / "mine", {"--allow-missing"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("000003.label: has 100 bytes"));
  EXPECT_THAT(answer.out, Not(HasSubstr("000003.label: is not there")));
  EXPECT_THAT(answer.out, HasSubstr("INCOMPLETE: 1 scan without"));
}

TEST_F(PredictionMistakes, NothingUsableIsToldFromNoTruth) {
  folder_.write("empty/000003.label", "");
  const cli::Answer answer = score(folder_ / "empty", {"--allow-missing"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("empty: holds no usable prediction of any scan with truth "
                                    "(passed over: "));
}

// The five scans in the middle of the sequence have only zeros.
TEST_F(PredictionMistakes, ClassesAreRecognisedInTheFirstScanAlone) {
  const auto in_first = [](std::uint32_t id) {
    return [id](std::size_t k, bool moving) { return k == 0 && moving ? id : 0U; };
  };
  const cli::Answer binary = score(write_ids("binary", in_first(1)));
  EXPECT_EQ(binary.exit_code, 3);
  EXPECT_THAT(binary.err, HasSubstr("binary: holds no other ids than 0 and 1"));
  const cli::Answer classes = score(write_ids("classes", in_first(2)));
  EXPECT_EQ(classes.exit_code, 0) << classes.err;
  EXPECT_THAT(classes.out, HasSubstr("taken for a network's classes"));
  EXPECT_THAT(classes.out, Not(HasSubstr("no point is predicted moving")));
}

TEST_F(PredictionMistakes, AnIdOutsideTheIdMapIsRefusedWithItsCount) {
  const fs::path odd =
      write_ids("odd", [](std::size_t k, bool moving) { return k == 4 && moving ? 7U : 1U; });
  const cli::Answer answer = score(odd, {"--id-map", "0:0,1:9,2:251"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, testing::ContainsRegex("000004.label: holds id 7 \\([0-9]+ points in all "
                                                 "files\\), expected only ids that the id map "
                                                 "names: 0, 1, 2 \\(read in format label"));
}

TEST_F(PredictionMistakes, IdsOfWhichNoneIsMovingAreListed) {
  const cli::Answer roads =
      score(write_ids("roads", [](std::size_t, bool moving) { return moving ? 10U : 40U; }));
  EXPECT_EQ(roads.exit_code, 0) << roads.err;
  EXPECT_THAT(roads.out,
              testing::ContainsRegex("no point is predicted moving; the files hold ids 10 "
                                     "\\([0-9,]+ points\\), 40 \\([0-9,]+ points\\); "
                                     "under protocol semantickitti-mos ids 251 to 25"));
  const cli::Answer swapped =
      score(write_ids("swapped", [](std::size_t, bool moving) { return moving ? 9U : 251U; }));
  EXPECT_EQ(swapped.exit_code, 0);
  EXPECT_THAT(swapped.out, HasSubstr("% of the points are predicted moving; the files hold ids 9"));
  EXPECT_THAT(score(folder_ / "room/../mine").out, Not(HasSubstr("predicted moving")));
}

TEST_F(PredictionMistakes, LabelsOfAnotherEncodingAreRefusedByName) {
  const auto float_of = [](float number) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    return bits;
  };
  for (const auto& [standing, moving] :
       {std::pair{0.0F, 1.0F}, std::pair{9.0F, 251.0F}, std::pair{0.125F, 0.875F}}) {
    const fs::path floats = write_ids(
        "floats", [&](std::size_t, bool moves) { return float_of(moves ? moving : standing); });
    const cli::Answer answer = score(floats);
    EXPECT_EQ(answer.exit_code, 3);
    EXPECT_THAT(answer.err, HasSubstr("000000.label: holds float32, expected a little-endian"));
  }
  const fs::path reversed = write_ids(
      "reversed", [](std::size_t, bool moving) { return moving ? 0xFB000000U : 0x09000000U; });
  EXPECT_THAT(score(reversed).err, HasSubstr("000000.label: holds big-endian uint32"));
  const fs::path reversed_instances = write_ids("reversed_instances", [](std::size_t, bool moving) {
    return moving ? 0xFB000300U : 0x09000000U;
  });
  EXPECT_THAT(score(reversed_instances).err, HasSubstr("000000.label: holds big-endian uint32"));
  // Instances of unlabelled points are legal.
  const fs::path instances =
      write_ids("instances", [](std::size_t, bool moving) { return moving ? 3U << 16U : 0U; });
  EXPECT_EQ(score(instances).exit_code, 0);
}

TEST_F(PredictionMistakes, AFolderThatDoesNotExistIsSaidToBeSo) {
  const cli::Answer answer = score(folder_ / "nowhere");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("nowhere: does not exist, expected a folder or file of pred"));
}

TEST_F(PredictionMistakes, MissingFilesAreToldAsOneRange) {
  for (const char* name : {"000001.label", "000002.label", "000003.label", "000005.label"})
    fs::remove(folder_ / "mine" / name);
  const cli::Answer answer = score(folder_ / "mine", {"--allow-missing"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out,
              HasSubstr("000001.label: is not there, nor what follows up to 000003.label"));
  EXPECT_THAT(answer.out, HasSubstr("000005.label: is not there, expected"));
  EXPECT_THAT(answer.out, Not(HasSubstr("000002.label")));
}

}  // namespace
}  // namespace mosbench
