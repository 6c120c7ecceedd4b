#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class Render : public testing::Test {
 protected:
  Render() {
    cli::write_small_sequence(folder_ / "00", 8);
    const cli::Answer answer = cli::run({"run", folder_ / "00", "--out", run(), "--threads", "1"});
    if (answer.exit_code != 0) throw std::runtime_error(answer.err);
  }
  std::string run() const { return folder_ / "runs/mine"; }

  TempFolder folder_;
};

TEST_F(Render, DrawsAScanWithoutBrowserAndTheSameEachTime) {
  for (const char* name : {"a.png", "b.png"}) {
    const cli::Answer answer =
        cli::run({"render", run(), "--scan", "6", "-o", folder_ / name, "--size", "400"});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_THAT(answer.out, HasSubstr("scan 000006 of 00 in "));
  }
  const std::string bytes = read_file(folder_ / "a.png");
  EXPECT_TRUE(bytes.starts_with("\x89PNG"));
  EXPECT_EQ(bytes, read_file(folder_ / "b.png"));
  EXPECT_EQ(cli::run({"render", run(), "--scan", "worst", "-o", folder_ / "w.png"}).exit_code, 0);
}

TEST_F(Render, ColoursWrongPointsByTheirScenesWhenAskedTo) {
  const auto draw = [&](const char* name, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"render", run(), "--scans", "1", "-o", folder_ / name});
    return cli::run(flags);
  };
  ASSERT_EQ(draw("plain.png", {}).exit_code, 0);
  ASSERT_EQ(draw("scenes.png", {"--show", "scenes"}).exit_code, 0);
  EXPECT_NE(read_file(folder_ / "plain.png"), read_file(folder_ / "scenes.png"));
  const cli::Answer both = draw("both.png", {"--show", "reasons,scenes"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--show: reasons and scenes both colour points"));
}

TEST_F(Render, RefusesScenesOfErrorsWithoutTruth) {
  std::filesystem::remove_all(folder_ / "00/labels");
  const std::string bare = folder_ / "bare";
  ASSERT_EQ(cli::run({"run", folder_ / "00", "--out", bare, "--threads", "1"}).exit_code, 0);
  for (const char* scans : {"1", "1-3"}) {
    const cli::Answer answer =
        cli::run({"render", bare, "--scans", scans, "-o", folder_ / "none", "--show", "scenes"});
    EXPECT_EQ(answer.exit_code, 3) << scans;
    EXPECT_THAT(answer.err, HasSubstr("has no truth of the chosen scans, expected scans with "));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  }
}

TEST_F(Render, DrawsTheSameOfLabelsThatWereScored) {
  const std::string net = folder_ / "net";
  ASSERT_EQ(cli::run({"score", folder_ / "00", "--predictions", run(), "--out", net}).exit_code, 0);
  for (const auto& [from, name] : {std::pair{run(), "run.png"}, std::pair{net, "net.png"}}) {
    const cli::Answer answer = cli::run({"render", from, "--scan", "6", "-o", folder_ / name});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  EXPECT_EQ(read_file(folder_ / "run.png"), read_file(folder_ / "net.png"));
}

TEST_F(Render, DrawsSeveralScansToAFolderInOneRange) {
  const cli::Answer answer =
      cli::run({"render", run(), "--scans", "5-6,2", "-o", folder_ / "pictures", "--size", "300"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("3 pictures in "));
  for (const char* stem : {"000002", "000005", "000006"}) {
    const std::string png = read_file(folder_ / "pictures" / (std::string(stem) + ".png"));
    EXPECT_TRUE(png.starts_with("\x89PNG")) << stem;
  }
  EXPECT_EQ(cli::run({"render", run(), "--scans", "90-99", "-o", folder_ / "none"}).exit_code, 2);
  EXPECT_EQ(cli::run({"render", run(), "-o", folder_ / "x.png"}).exit_code, 2);
  EXPECT_EQ(
      cli::run({"render", run(), "--scan", "1", "--scans", "1", "-o", folder_ / "x.png"}).exit_code,
      2);
}

TEST_F(Render, TurnsACameraAroundTheSensorAndDrawsBoxes) {
  const auto drawn = [&](const std::string& out, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"render", run(), "-o", folder_ / out, "--size", "300"});
    const cli::Answer answer = cli::run(flags);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return out.ends_with(".png") ? read_file(folder_ / out) : "";
  };
  drawn("turn",
        {"--scans", "5-7", "--view", "orbit", "--azimuth", "10", "--turn", "40", "--range", "9"});
  // The camera of the second picture looks from the middle of the way.
  EXPECT_EQ(read_file(folder_ / "turn/000006.png"),
            drawn("a.png", {"--scan", "6", "--view", "orbit", "--azimuth", "30", "--range", "9"}));
  EXPECT_NE(read_file(folder_ / "turn/000006.png"),
            drawn("b.png", {"--scan", "6", "--range", "9"}));
  EXPECT_NE(drawn("c.png", {"--scan", "6", "--boxes", "--range", "9"}),
            read_file(folder_ / "b.png"));
  for (const auto& flags :
       std::vector<std::vector<std::string>>{{"--scans", "6", "--view", "top:5"},
                                             {"--scan", "6", "--view", "orbit", "--turn", "5"}}) {
    std::vector<std::string> words = {"render", run(), "-o", folder_ / "d.png"};
    words.insert(words.end(), flags.begin(), flags.end());
    EXPECT_EQ(cli::run(words).exit_code, 2);
  }
}

/// Draws scans 1 and 2 with this script as ffmpeg, or with none.
cli::Answer render_video(const std::string& run, const TempFolder& folder, const char* script,
                         const char* name = "v.mp4") {
  const std::filesystem::path programs = folder / "programs";
  std::filesystem::create_directories(programs);
  if (script != nullptr) {
    write_file_atomic(programs / "ffmpeg", script);
    std::filesystem::permissions(programs / "ffmpeg", std::filesystem::perms::owner_all);
  }
  return cli::run({"render", run, "--scans", "1-2", "-o", folder / name, "--size", "300"},
                  [&] { setenv("PATH", programs.c_str(), 1); });
}

TEST_F(Render, HandsThePicturesOfAVideoToFfmpeg) {
  const cli::Answer made =
      render_video(run(), folder_, "#!/bin/sh\nfor last; do :; done\n/bin/cat > \"$last\"\n");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("2 pictures in the video "));
  ASSERT_EQ(
      cli::run({"render", run(), "--scans", "1-2", "-o", folder_ / "p", "--size", "300"}).exit_code,
      0);
  EXPECT_EQ(read_file(folder_ / "v.mp4"),
            read_file(folder_ / "p/000001.png") + read_file(folder_ / "p/000002.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "v.partial.mp4"));
}

TEST_F(Render, LeavesNoVideoWhereFfmpegFailsOrIsNotThere) {
  const cli::Answer failed = render_video(run(), folder_, "#!/bin/sh\nexit 1\n");
  EXPECT_EQ(failed.exit_code, 3);
  EXPECT_THAT(failed.err, HasSubstr("could not be made by ffmpeg"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "v.mp4"));
  std::filesystem::remove(folder_ / "programs/ffmpeg");
  const cli::Answer without = render_video(run(), folder_, nullptr);
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_THAT(without.err, HasSubstr("ffmpeg is not there"));
  EXPECT_THAT(without.err, HasSubstr("-pattern_type glob -i '" + (folder_ / "v/*.png").string()));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "v/000002.png"));
}

TEST_F(Render, KnowsAVideoByItsEndInCapitalsToo) {
  const cli::Answer without = render_video(run(), folder_, nullptr, "V.MP4");
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_THAT(without.err, HasSubstr("ffmpeg is not there"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "V/000002.png"));
}

TEST_F(Render, KnowsNoWorstScanWithoutTruth) {
  std::filesystem::remove_all(folder_ / "00/labels");
  const std::string bare = folder_ / "runs/bare";
  ASSERT_EQ(cli::run({"run", folder_ / "00", "--out", bare}).exit_code, 0);
  const cli::Answer one = cli::run({"render", bare, "--scan", "worst", "-o", folder_ / "w.png"});
  EXPECT_EQ(one.exit_code, 2);
  EXPECT_THAT(one.err,
              HasSubstr("--scans: worst: no scan of the result has truth, expected 0 to 7"));
  EXPECT_EQ(cli::run({"render", bare, "--scans", "worst:2", "-o", folder_ / "pictures"}).exit_code,
            2);
}

TEST_F(Render, RefusesVideosThatItDoesNotWrite) {
  for (const char* name : {"v.webm", "v.AVI", "v.png"}) {
    const cli::Answer answer =
        cli::run({"render", run(), "--scans", "1-2", "-o", folder_ / name, "--size", "300"});
    EXPECT_EQ(answer.exit_code, 2);
    EXPECT_THAT(answer.err, HasSubstr("is not written of several scans, expected .mp4, .gif or"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
  }
}

TEST_F(Render, RefusesPlacesThatCanHoldNoPicturesBeforeTheWork) {
  folder_.write("file", "");
  std::filesystem::create_directories(folder_ / "folder.mp4");
  for (const auto& [out, wrong] :
       {std::pair{"file", "is no folder"}, std::pair{"folder.mp4", "is a folder"}}) {
    const cli::Answer answer =
        cli::run({"render", folder_ / "nothing", "--scans", "1-2", "-o", folder_ / out});
    EXPECT_EQ(answer.exit_code, 3);
    EXPECT_THAT(answer.err, HasSubstr(wrong));
  }
}

TEST_F(Render, ColoursReasonsWhereTheRunKeptThem) {
  const std::string plus = folder_ / "plus";
  ASSERT_EQ(
      cli::run({"run", folder_ / "00", "--preset", "best", "--scores", "--out", plus}).exit_code,
      0);
  const auto picture = [&](std::vector<std::string> flags) {
    std::vector<std::string> words = {"render", plus, "--scan", "6", "-o", folder_ / "a.png"};
    words.insert(words.end(), flags.begin(), flags.end());
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return read_file(folder_ / "a.png");
  };
  EXPECT_NE(picture({"--reasons"}), picture({}));
  const cli::Answer refused =
      cli::run({"render", run(), "--scan", "6", "-o", folder_ / "c.png", "--reasons"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(
      refused.err,
      HasSubstr(
          "reasons: is not there, expected a run of mosbench run --write scores by a method"));
}

TEST_F(Render, RefusesScansAndSequencesThatAreNotThere) {
  for (const char* scan : {"8", "-1", "best", ""}) {
    const cli::Answer answer = cli::run({"render", run(), "--scan", scan, "-o", folder_ / "r.png"});
    EXPECT_EQ(answer.exit_code, 2) << scan;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "r.png"));
  }
  const cli::Answer answer =
      cli::run({"render", run(), "--sequence", "01", "--scan", "1", "-o", folder_ / "r.png"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("holds no results of \"01\", expected one of 00"));
}

}  // namespace
}  // namespace mosbench
