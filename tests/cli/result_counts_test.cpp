#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::HasSubstr;

/// The result of a run, whose members are then changed as a stranger might.
class ResultCounts : public testing::Test {
 protected:
  ResultCounts() {
    cli::write_small_sequence(folder_ / "room", 6);
    const cli::Answer run = cli::run({"run", folder_ / "room", "--out", folder_ / "out"});
    if (run.exit_code != 0) throw std::runtime_error(run.err);
    content_ = ordered_json::parse(read_file(file()));
  }
  fs::path file() const { return folder_ / "out/room/result.json"; }

  /// What stats, compare and bless say, which all refuse.
  std::string refusal(const ordered_json& content) const {
    write_file_atomic(file(), content.dump());
    const fs::path out = folder_ / "out";
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"compare", out, out},
          std::vector<std::string>{"bless", out, folder_ / "baseline"}}) {
      EXPECT_EQ(cli::run(command).exit_code, 3) << command.front();
    }
    EXPECT_FALSE(fs::exists(folder_ / "baseline"));
    const cli::Answer answer = cli::run({"stats", out});
    EXPECT_EQ(answer.exit_code, 3) << answer.out;
    return answer.err;
  }

  TempFolder folder_;
  ordered_json content_;
};

TEST_F(ResultCounts, ThatAreNoNumbersOfPointsAreRefused) {
  ASSERT_EQ(cli::run({"stats", folder_ / "out"}).exit_code, 0);
  for (const char* name : {"points", "predicted_moving_points", "nonfinite_points", "tp", "fp",
                           "fn", "tn", "ignored", "unknown_ids"}) {
    for (const char* value :
         {"-5", "1.7", "1e3", "18446744073709551616", "1e400", "null", "\"7\"", "true", "[1]"}) {
      ordered_json content = content_;
      content["scans"][3][name] = "REPLACED";
      std::string text = content.dump();
      text.replace(text.find("\"REPLACED\""), 10, value);
      write_file_atomic(file(), text);
      const cli::Answer answer = cli::run({"stats", folder_ / "out"});
      EXPECT_EQ(answer.exit_code, 3) << name << ' ' << value << answer.out;
      EXPECT_THAT(answer.err, HasSubstr("result.json: ")) << name << ' ' << value;
    }
  }
  content_["scans"][3]["tp"] = -5;
  EXPECT_THAT(refusal(content_), HasSubstr("result.json: \"tp\" of scan \"000003\" is -5, expected "
                                           "a number of points"));
}

TEST_F(ResultCounts, ThatDoNotFitTheirScanAreRefused) {
  for (const char* name : {"tp", "fp", "fn", "tn", "ignored", "points"}) {
    ordered_json content = content_;
    content["scans"][3][name] = content["scans"][3][name].get<int>() + 1;
    EXPECT_THAT(refusal(content), HasSubstr("the counts of scan \"000003\" do not fit its 8"));
  }
  // Sums that wrap around.
  ordered_json wrapped = content_;
  wrapped["scans"][3]["tp"] = 0x8000000000000000U;
  wrapped["scans"][3]["fp"] = 0x8000000000000000U;
  EXPECT_THAT(refusal(wrapped), HasSubstr("do not fit"));
  ordered_json predicted = content_;
  predicted["scans"][3]["predicted_moving_points"] = cli::kPointsPerScan + 1;
  EXPECT_THAT(refusal(predicted), HasSubstr("do not fit"));
}

TEST_F(ResultCounts, OfSettingsThatTheMethodCannotHaveAreRefused) {
  const auto with = [&](const char* name, const ordered_json& value) {
    ordered_json content = content_;
    content["settings"][name] = value;
    return refusal(content);
  };
  EXPECT_THAT(with("local_window_scans", "nan"),
              HasSubstr("result.json: settings: local_window_scans: \"nan\" "));
  EXPECT_THAT(with("kernel_width_voxels", 2.5), HasSubstr("settings: kernel_width_voxels: 2.5 "));
  EXPECT_THAT(with("max_range_m", -3), HasSubstr("settings: max_range_m: "));
  EXPECT_THAT(with("variant", "paper-1924"), HasSubstr("settings: variant: "));
  // What another version may have known.
  content_["settings"]["window_of_old"] = 3;
  write_file_atomic(file(), content_.dump());
  EXPECT_EQ(cli::run({"stats", folder_ / "out"}).exit_code, 0);
}

TEST_F(ResultCounts, ThatAreNotThoseOfTheSummaryAreRefused) {
  ordered_json& scan = content_["scans"][3];
  scan["fn"] = scan["fn"].get<int>() + 1;
  scan["tn"] = scan["tn"].get<int>() - 1;
  EXPECT_THAT(refusal(content_), HasSubstr("\"fn\" of its scans add up to "));
}

TEST(ResultLabels, ThatWereReplacedAfterTheRunAreADoubtOfEveryTable) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 4);
  const std::string out = folder / "out", labels = folder / "out/room/labels/";
  ASSERT_EQ(cli::run({"run", folder / "room", "--out", out}).exit_code, 0);
  const char* doubt = "LABELS CHANGED after the run: of 4 label files ";
  EXPECT_THAT(cli::run({"stats", out}).out, testing::Not(testing::HasSubstr(doubt)));
  std::filesystem::remove(labels + "000001.label");
  folder.write("out/room/labels/000002.label", "12345678");
  const std::string whole = std::string(doubt) +
                            "1 are gone and 1 of another size, first 000002.label with 2 labels "
                            "for 8640 points";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"stats", out}, {"rank", out}, {"compare", out, out}}) {
    for (const char* as : {"text", "json", "csv"}) {
      std::vector<std::string> all = words;
      all.insert(all.end(), {"--as", as});
      EXPECT_THAT(cli::run(all).out, testing::HasSubstr(whole)) << words.front() << as;
    }
  }
  ASSERT_EQ(cli::run({"run", folder / "room", "--out", out, "--overwrite"}).exit_code, 0);
  EXPECT_THAT(cli::run({"score", folder / "room", "--predictions", out}).out,
              testing::Not(testing::HasSubstr("LABELS CHANGED")));
  // Others of equal number and size are told by who reads them.
  folder.write("out/room/labels/000003.label", std::string(4 * 8640, '\t'));
  EXPECT_THAT(cli::run({"score", folder / "room", "--predictions", out}).out,
              testing::HasSubstr("LABELS CHANGED after the run: 1 of 4 label files are not what "
                                 "it wrote, first 000003.label"));
  // A result alone, as of a baseline, has none that could be others.
  std::filesystem::remove_all(labels);
  EXPECT_THAT(cli::run({"stats", out}).out, testing::Not(testing::HasSubstr(doubt)));
}

}  // namespace
}  // namespace mosbench
