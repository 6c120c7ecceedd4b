#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A run of the small sequence, made once for all tests of a process.
const std::filesystem::path& small_run() {
  static const TempFolder folder;
  static const bool made = [] {
    cli::write_small_sequence(folder / "scans/00", 8);
    const cli::Answer answer =
        cli::run({"run", folder / "scans/00", "--out", folder / "runs/mine", "--threads", "1"});
    if (answer.exit_code != 0) throw std::runtime_error(answer.err);
    return true;
  }();
  static const std::filesystem::path path = made ? folder.path() : "";
  return path;
}

nlohmann::ordered_json content_of(const std::string& html) {
  const std::string opening = "<script type=\"application/json\" id=\"report\">";
  const std::size_t start = html.find(opening) + opening.size();
  return nlohmann::ordered_json::parse(html.substr(start, html.find("</script>", start) - start));
}

TEST(Report, HoldsTheResultAndAllScansThatFit) {
  const TempFolder folder;
  const cli::Answer answer =
      cli::run({"report", small_run() / "runs/mine", "-o", folder / "r.html"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("report of 1 result in "));
  const auto content = content_of(read_file(folder / "r.html"));
  EXPECT_EQ(content.at("results").at(0).at("run"), "mine");
  EXPECT_EQ(content.at("results").at(0).at("result"),
            nlohmann::ordered_json::parse(read_file(small_run() / "runs/mine/00/result.json")));
  EXPECT_EQ(content.at("clouds").at(0).at("scans").size(), 8U);
  EXPECT_EQ(content.at("clouds").at(0).at("left_out"), "");
}

TEST(Report, HoldsTheWayOfTheSensorAndHowFarOtherPosesAreOffThoseOfTheDataSet) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room/00", 4);
  // A camera's poses, as Tr says: its x ahead is the lidar's y.
  write_file_atomic(folder / "room/00/calib.txt", "Tr: 0 1 0 0 -1 0 0 0 0 0 1 0\n");
  std::vector<Pose> own(4, Pose::Identity()), drifting(4, Pose::Identity());
  for (int k = 0; k < 4; ++k) {
    own[static_cast<std::size_t>(k)].translation().x() = 0.3 * k;
    drifting[static_cast<std::size_t>(k)].translation() = Eigen::Vector3d(7, 0.3 * k, 0.1 * k);
  }
  write_poses(folder / "room/00/poses.txt", own);
  write_poses(folder / "drifting.txt", drifting);
  const auto run = [&](const char* out, std::vector<std::string> poses) {
    std::vector<std::string> words = {"run", folder / "room/00", "--out", folder / out};
    words.insert(words.end(), poses.begin(), poses.end());
    ASSERT_EQ(cli::run(words).exit_code, 0);
  };
  run("own", {});
  run("other", {"--poses", folder / "drifting.txt", "--pose-frame", "lidar"});
  const auto answer =
      cli::run({"report", folder / "own", folder / "other", "-o", folder / "r.html"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto results = content_of(read_file(folder / "r.html")).at("results");
  const auto way = nlohmann::ordered_json::parse("[[0,0],[0,0.3],[0,0.6],[0,0.9]]");
  EXPECT_EQ(results.at(0).at("path"), nlohmann::ordered_json({{"run_m", way}}));
  const auto& other = results.at(1).at("path");
  EXPECT_EQ(other.at("run_m"), way);
  EXPECT_EQ(other.at("own_m"), way);
  EXPECT_EQ(other.at("way_m"), nlohmann::ordered_json({0.0, 0.3, 0.6, 0.9}));
  EXPECT_EQ(other.at("off_m"), nlohmann::ordered_json({0.0, 0.1, 0.2, 0.3}));
}

TEST(Report, PassesOverWhatKilledRunsLeft) {
  const TempFolder folder;
  for (const char* name : {"00", "00.partial", "00.replaced"}) {
    std::filesystem::create_directories(folder / "run" / name);
    std::filesystem::copy(small_run() / "runs/mine/00/result.json", folder / "run" / name);
  }
  const cli::Answer answer =
      cli::run({"report", folder / "run", "-o", folder / "r.html", "--scans", "none"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("report of 1 result in "));
}

TEST(Report, HoldsTheDynamicScoresOfARunThatKeptThem) {
  const TempFolder folder;
  EXPECT_TRUE(std::filesystem::exists(small_run()));
  const auto scored = cli::run({"run", small_run() / "scans/00", "--out", folder / "runs/scored",
                                "--threads", "1", "--scores"});
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto report = [&] {
    return cli::run(
        {"report", small_run() / "runs/mine", folder / "runs/scored", "-o", folder / "r.html"});
  };
  ASSERT_EQ(report().exit_code, 0);
  const auto content = content_of(read_file(folder / "r.html"));
  EXPECT_TRUE(content.at("results").at(0).at("scores").empty());
  EXPECT_EQ(content.at("results").at(1).at("scores").size(), 8U);
  EXPECT_TRUE(content.at("results").at(1).at("reasons").empty());
  const auto file = folder / "runs/scored/00/scores/000005.score";
  std::filesystem::resize_file(file, 12);
  const cli::Answer cut = report();
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, HasSubstr("000005.score: has 12 bytes"));
  std::filesystem::remove(file);
  EXPECT_EQ(report().exit_code, 3);
}

TEST(Report, HoldsTheReasonsOfRunsThatKeptThem) {
  const TempFolder folder;
  const auto plus = folder / "plus";
  ASSERT_EQ(
      cli::run({"run", small_run() / "scans/00", "--preset", "best", "--scores", "--out", plus})
          .exit_code,
      0);
  const auto report = [&] { return cli::run({"report", plus, "-o", folder / "r.html"}); };
  ASSERT_EQ(report().exit_code, 0);
  EXPECT_EQ(content_of(read_file(folder / "r.html")).at("results").at(0).at("reasons").size(), 8U);
  std::filesystem::resize_file(std::filesystem::path(plus) / "00/reasons/000005.reason", 12);
  const cli::Answer cut = report();
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, HasSubstr("000005.reason: has 12 bytes"));
}

/// Two methods with scores and the labels of one of them as another's, in one folder each.
void write_several_runs(const std::filesystem::path& folder) {
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"run", small_run() / "scans/00", "--method", "hmm-mos,underwood", "--scores", "--out",
            folder / "all"},
           {"score", small_run() / "scans/00", "--predictions", folder / "all/underwood",
            "--method", "Net", "--out", folder / "net"}}) {
    const cli::Answer answer = cli::run(words);
    if (answer.exit_code != 0) throw std::runtime_error(answer.err);
  }
}

TEST(Report, HoldsTheRadialVelocitiesOfAnAeva) {
  const TempFolder folder;
  const std::string data = folder / "sim", run = folder / "run", page = folder / "r.html";
  ASSERT_EQ(cli::run({"simulate", "--layout", "helipr", "--scene", "room", "--scans", "6", "--seed",
                      "5", "--out", data})
                .exit_code,
            0);
  ASSERT_EQ(cli::run({"run", data, "--out", run}).exit_code, 0);
  const cli::Answer answer = cli::run({"report", run, "-o", page, "--scans", "4-5"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto clouds = content_of(read_file(page)).at("clouds");
  ASSERT_EQ(clouds.size(), 2U);
  EXPECT_EQ(clouds[0].at("sequence"), "room/Aeva");
  for (const auto& scan : clouds[0].at("scans")) EXPECT_TRUE(scan.contains("radial_velocities"));
  for (const auto& scan : clouds[1].at("scans")) EXPECT_FALSE(scan.contains("radial_velocities"));
}

TEST(Report, RanksSeveralRunsAsRankDoes) {
  const TempFolder folder;
  write_several_runs(folder.path());
  const std::string all = folder / "all", net = folder / "net", out = folder / "r.html";
  const cli::Answer answer = cli::run({"report", all, net, all + "/underwood", "-o", out});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("report of 3 results in "));
  const auto content = content_of(read_file(out));
  ASSERT_EQ(content.at("leaderboards").size(), 1U);
  const auto& rows = content.at("leaderboards").at(0).at("rows");
  const auto expected =
      nlohmann::ordered_json::parse(cli::run({"rank", all, net, "--format", "json"}).out);
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    for (const char* key : {"method", "all", "to_first", "ms_per_scan", "memory_mb", "on_front"}) {
      EXPECT_EQ(rows.at(r).at(key), expected.at("rows").at(r).at(key)) << r << key;
    }
    const auto& result =
        content.at("results").at(rows.at(r).at("results").at(0).get<std::size_t>());
    EXPECT_EQ(result.at("run"), rows.at(r).at("run"));
    EXPECT_EQ(result.at("result").at("method").at("name"), rows.at(r).at("method"));
    EXPECT_TRUE(result.contains("cloud"));
  }
}

TEST(Report, HoldsTheCurvesOfRunsWithScoresAndWhatTheyAreCalled) {
  const TempFolder folder;
  write_several_runs(folder.path());
  const std::string out = folder / "r.html";
  ASSERT_EQ(cli::run({"report", folder / "all", small_run() / "runs/mine", "-o", out}).exit_code,
            0);
  const auto content = content_of(read_file(out));
  const auto& curves = content.at("curves");
  ASSERT_EQ(curves.size(), 2U) << "the third run kept no scores";
  for (const auto& curve : curves) {
    const std::string run = curve.at("run");
    const auto expected = nlohmann::ordered_json::parse(
        cli::run({"curve", folder / "all" / run, "--format", "json"}).out);
    for (const char* key : {"average_precision", "best", "labels"}) {
      EXPECT_EQ(curve.at(key), expected.at(key)) << run << key;
    }
    EXPECT_EQ(curve.at("recall").size(), curve.at("precision").size());
    EXPECT_EQ(curve.at("recall").back(), 1.0);
  }
  const auto& results = content.at("results");
  EXPECT_EQ(results.at(0).at("score_name"), "dynamic score");
  EXPECT_EQ(results.at(0).at("threshold_name"), "Otsu threshold");
  EXPECT_EQ(results.at(1).at("score_name"), "margin, m");
}

TEST(Report, OfOneRunHasNoLeaderboard) {
  const TempFolder folder;
  const std::string out = folder / "r.html";
  ASSERT_EQ(cli::run({"report", small_run() / "runs/mine", "-o", out}).exit_code, 0);
  EXPECT_TRUE(content_of(read_file(out)).at("leaderboards").empty());
}

TEST(Report, IsTheSameBytesEachTime) {
  const TempFolder folder;
  for (const char* name : {"a.html", "b.html"}) {
    ASSERT_EQ(cli::run({"report", small_run() / "runs", "-o", folder / name}).exit_code, 0);
  }
  EXPECT_EQ(read_file(folder / "a.html"), read_file(folder / "b.html"));
}

TEST(Report, StaysBelowTheLimitAndSaysWhatItLeftOut) {
  const TempFolder folder;
  const auto report = [&](const std::string& name, std::vector<std::string> flags) {
    std::vector<std::string> words = {"report", small_run() / "runs/mine", "-o", folder / name};
    words.insert(words.end(), flags.begin(), flags.end());
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return answer.out;
  };
  const auto bytes = [&](const char* name) {
    return static_cast<double>(std::filesystem::file_size(folder / name));
  };
  report("one.html", {"--scans", "0"});
  report("all.html", {"--scans", "all"});
  const double limit_mb = (0.4 * bytes("one.html") + 0.6 * bytes("all.html")) / 1e6;
  const std::string out = report("some.html", {"--max-mb", std::to_string(limit_mb)});
  EXPECT_LE(bytes("some.html"), 1e6 * limit_mb);
  const auto cloud = content_of(read_file(folder / "some.html")).at("clouds").at(0);
  ASSERT_LT(cloud.at("scans").size(), 8U);
  ASSERT_GT(cloud.at("scans").size(), 0U);
  EXPECT_THAT(cloud.at("left_out").get<std::string>(), HasSubstr("--max-mb"));
  EXPECT_THAT(out, HasSubstr(cloud.at("left_out").get<std::string>()));
}

TEST(Report, RefusesALimitWithoutRoomForASingleScan) {
  const TempFolder folder;
  const auto report = [&](const std::string& name, const std::string& limit_mb) {
    return cli::run({"report", small_run() / "runs/mine", "-o", folder / name, "--scans", "0",
                     "--max-mb", limit_mb});
  };
  ASSERT_EQ(report("one.html", "25").exit_code, 0);
  const auto bytes = static_cast<double>(std::filesystem::file_size(folder / "one.html"));
  cli::Answer none;
  for (double limit = bytes - 4e3; limit < bytes + 4e3; limit += 500) {
    none = report("none.html", std::to_string(limit / 1e6));
    if (none.err.find("no room for the numbers alone") == std::string::npos) break;
  }
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--max-mb: has no room for a single scan"));
  EXPECT_FALSE(std::filesystem::exists(folder / "none.html"));
}

TEST(Report, TakesTheScansThatAreAskedFor) {
  const TempFolder folder;
  const cli::Answer answer =
      cli::run({"report", small_run() / "runs", "-o", folder / "r.html", "--scans", "6,1-2,99"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto cloud = content_of(read_file(folder / "r.html")).at("clouds").at(0);
  std::vector<int> scans;
  for (const auto& scan : cloud.at("scans")) scans.push_back(scan.at("index"));
  EXPECT_EQ(scans, (std::vector<int>{1, 2, 6}));
  EXPECT_EQ(cloud.at("left_out"), "the points of 3 of 8 scans are in the file; --scans chose 3");
}

TEST(Report, WithoutPointsNeedsNoDataSet) {
  const TempFolder folder;
  std::filesystem::copy(small_run() / "runs/mine/00/result.json", folder / "result.json");
  const cli::Answer answer =
      cli::run({"report", folder.path(), "-o", folder / "r.html", "--scans", "none"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_TRUE(content_of(read_file(folder / "r.html")).at("clouds").empty());
}

/// The result of `mosbench score` for the labels of the small run, with more flags.
cli::Answer score_small_run(const std::filesystem::path& predictions,
                            const std::filesystem::path& out, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {
      "score", small_run() / "scans/00", "--predictions", predictions, "--out", out};
  words.insert(words.end(), more.begin(), more.end());
  return cli::run(words);
}

TEST(Report, ShowsLabelsThatWereScoredBesideThoseOfARun) {
  const TempFolder folder;
  ASSERT_EQ(score_small_run(small_run() / "runs/mine", folder / "net").exit_code, 0);
  const cli::Answer answer = cli::run({"report", folder / "net", small_run() / "runs/mine", "-o",
                                       folder / "r.html", "--scans", "5-7"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const std::string html = read_file(folder / "r.html");
  const auto content = content_of(html);
  ASSERT_EQ(content.at("clouds").size(), 1U) << "they share the positions";
  const auto block = [&](std::size_t result, std::size_t scan) {
    const std::string opening =
        "id=\"block-" + content.at("results").at(result).at("outcomes").at(scan).dump() + "\">";
    const std::size_t start = html.find(opening) + opening.size();
    return html.substr(start, html.find("</script>", start) - start);
  };
  for (std::size_t scan = 0; scan < 3; ++scan) EXPECT_EQ(block(0, scan), block(1, scan)) << scan;
  EXPECT_NE(block(0, 0), block(0, 1));
  EXPECT_EQ(content.at("results").at(0).at("breakdown"),
            content.at("results").at(1).at("breakdown"));
}

TEST(Report, ShowsOnlyTheScansThatWereScored) {
  const TempFolder folder;
  std::filesystem::copy(small_run() / "runs/mine/00/labels", folder / "labels");
  for (const char* missing : {"000002.label", "000006.label"}) {
    std::filesystem::remove(folder / "labels" / missing);
  }
  ASSERT_EQ(score_small_run(folder / "labels", folder / "net", {"--allow-missing"}).exit_code, 0);
  ASSERT_EQ(cli::run({"report", folder / "net", "-o", folder / "r.html"}).exit_code, 0);
  const auto content = content_of(read_file(folder / "r.html"));
  EXPECT_EQ(content.at("clouds").at(0).at("scans").size(), 6U);
  const auto& rows = content.at("results").at(0).at("result").at("scans");
  ASSERT_EQ(rows.size(), 8U) << "a row per scan, as of runs";
  EXPECT_EQ(rows.at(2).at("stem"), "000002");
  EXPECT_FALSE(rows.at(2).contains("tp"));
  EXPECT_TRUE(rows.at(3).contains("tp"));
  EXPECT_THAT(content.at("results").at(0).at("doubts").dump(),
              HasSubstr("INCOMPLETE: 2 scans without usable prediction are not counted"));
  const cli::Answer render =
      cli::run({"render", folder / "net", "--scan", "2", "-o", folder / "2.png"});
  EXPECT_EQ(render.exit_code, 2);
  EXPECT_THAT(render.err, HasSubstr("scan 2 (000002) was not scored"));
}

TEST(Report, RefusesLabelsThatAreNotThoseThatWereScored) {
  const TempFolder folder;
  std::filesystem::copy(small_run() / "runs/mine/00/labels", folder / "labels");
  ASSERT_EQ(score_small_run(folder / "labels", folder / "net").exit_code, 0);
  const auto report = [&] { return cli::run({"report", folder / "net", "-o", folder / "r.html"}); };
  std::filesystem::copy_file(folder / "labels/000000.label", folder / "labels/000007.label",
                             std::filesystem::copy_options::overwrite_existing);
  const cli::Answer changed = report();
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_THAT(changed.err, HasSubstr("labels/000007: does not give the counts in result.json"));
  std::filesystem::remove_all(folder / "labels");
  const cli::Answer gone = report();
  EXPECT_EQ(gone.exit_code, 3);
  EXPECT_THAT(gone.err, HasSubstr("labels"));
  EXPECT_EQ(
      cli::run({"report", folder / "net", "-o", folder / "r.html", "--scans", "none"}).exit_code,
      0);
}

TEST(Report, SaysWhereThereAreNoLabelsToShow) {
  const TempFolder folder;
  const auto lost = small_run() / "runs/mine/00/result.json";
  std::filesystem::copy(lost, folder / "result.json");
  const cli::Answer without = cli::run({"report", folder / "result.json", "-o", folder / "r.html"});
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_THAT(without.err, HasSubstr("result.json: has no labels/ next to it"));
  EXPECT_THAT(without.err, HasSubstr("--scans none"));
  ASSERT_EQ(score_small_run(small_run() / "runs/mine", folder / "net").exit_code, 0);
  auto older = nlohmann::ordered_json::parse(read_file(folder / "net/00/result.json"));
  older.erase("places");
  write_file_atomic(folder / "net/00/result.json", older.dump());
  const cli::Answer untold = cli::run({"report", folder / "net", "-o", folder / "r.html"});
  EXPECT_EQ(untold.exit_code, 3);
  EXPECT_THAT(untold.err, HasSubstr("result.json: does not say where its labels are"));
}

/// A copy of the small sequence that only flags make readable: poses elsewhere and turned round,
/// five numbers per point.
void write_sequence_that_needs_flags(const std::filesystem::path& folder) {
  cli::write_small_sequence(folder / "00", 8);
  std::vector<Pose> sensor_from_map(8, Pose::Identity());
  for (std::size_t k = 0; k < 8; ++k) {
    const std::filesystem::path file = folder / "00/velodyne" / (cli::stem(k) + ".bin");
    const std::string four = read_file(file);
    std::string five;
    for (std::size_t at = 0; at < four.size(); at += 16) {
      five += four.substr(at, 16) + std::string(4, '\0');
    }
    write_file_atomic(file, five);
    sensor_from_map[k].translation().x() = 0.01 * static_cast<double>(k);
  }
  write_poses(folder / "turned.txt", sensor_from_map);
}

TEST(Report, ReadsTheScansAsTheRunWasTold) {
  const TempFolder folder;
  write_sequence_that_needs_flags(folder.path());
  const cli::Answer run = cli::run({"run", folder / "00", "--out", folder / "run", "--threads", "1",
                                    "--poses", folder / "turned.txt", "--pose-direction",
                                    "sensor-from-map", "--bin-columns", "5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const cli::Answer answer = cli::run({"report", folder / "run", "-o", folder / "r.html"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto cloud = content_of(read_file(folder / "r.html")).at("clouds").at(0);
  EXPECT_EQ(cloud.at("scans").at(7).at("points"), cli::kPointsPerScan);
  EXPECT_EQ(cloud.at("scans").at(7).at("map_from_sensor").at(3), -0.07);
}

TEST(Report, SaysWhatIsReadInAnotherWayThanByTheRun) {
  const TempFolder folder;
  write_sequence_that_needs_flags(folder.path());
  ASSERT_EQ(
      cli::run({"run", folder / "00", "--out", folder / "run", "--threads", "1", "--poses",
                folder / "turned.txt", "--pose-direction", "sensor-from-map", "--bin-columns", "5"})
          .exit_code,
      0);
  auto json = nlohmann::ordered_json::parse(read_file(folder / "run/00/result.json"));
  ASSERT_EQ(json.at("places").at("reading").erase("pose_direction"), 1U);
  write_file_atomic(folder / "run/00/result.json", json.dump());
  const cli::Answer answer = cli::run({"report", folder / "run", "-o", folder / "r.html"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("pose_direction was \"sensor_from_map, inverted\" and is "
                                    "\"map_from_sensor\" now"));
}

TEST(Report, RefusesLabelsThatDoNotGiveTheCountsOfTheResult) {
  const TempFolder folder;
  std::filesystem::copy(small_run() / "runs/mine", folder / "run",
                        std::filesystem::copy_options::recursive);
  const auto file = folder / "run/00/labels/000005.label";
  std::string bytes = read_file(file);
  bytes[0] = static_cast<char>(bytes[0] == 9 ? 251 : 9);
  write_file_atomic(file, bytes);
  const cli::Answer answer = cli::run({"report", folder / "run", "-o", folder / "r.html"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("000005.label: does not give the counts in result.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html"));
}

TEST(Report, RefusesADataSetThatIsNotTheOneOfTheRun) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "00", 7);
  const cli::Answer answer =
      cli::run({"report", small_run() / "runs", "-o", folder / "r.html", "--data", folder / "00"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("was made from other scans, poses or labels than 00 holds"));
}

TEST(Report, TakesACopyOfTheDataSet) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "00", 8);
  const cli::Answer answer =
      cli::run({"report", small_run() / "runs", "-o", folder / "r.html", "--data", folder / "00"});
  EXPECT_EQ(answer.exit_code, 0) << answer.err;
}

TEST(Report, NamesWhatCannotBeUsed) {
  const TempFolder folder;
  const std::string run = small_run() / "runs";
  const std::string out = folder / "r.html";
  EXPECT_EQ(cli::run({"report", folder.path(), "-o", out}).exit_code, 3);
  EXPECT_EQ(cli::run({"report", run}).exit_code, 2);
  const cli::Answer choice = cli::run({"report", run, "-o", out, "--scans", "best"});
  EXPECT_EQ(choice.exit_code, 2);
  EXPECT_THAT(choice.err, HasSubstr("--scans: 'best' is not known"));
  const cli::Answer none = cli::run({"report", run, "-o", out, "--scans", "50"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--scans: chooses no scan, expected some of 0 to 7"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const cli::Answer small = cli::run({"report", run, "-o", out, "--max-mb", "0.2"});
  EXPECT_EQ(small.exit_code, 2);
  EXPECT_THAT(small.err, HasSubstr("no room for the numbers alone"));
  const auto broken = folder.write("broken/result.json", R"({"sequence": 7})");
  EXPECT_EQ(cli::run({"report", broken.parent_path(), "-o", out}).exit_code, 3);
}

TEST(Report, LeavesNoOpeningBracketOfANameInTheContent) {
  const TempFolder folder;
  const std::string evil = "</script><img src=x onerror=alert(1)>";
  auto json = nlohmann::ordered_json::parse(read_file(small_run() / "runs/mine/00/result.json"));
  json["remarks"] = {evil};
  json["sequence"] = evil;
  folder.write("result.json", json.dump());
  const cli::Answer answer =
      cli::run({"report", folder.path(), "-o", folder / "r.html", "--scans", "none"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const std::string html = read_file(folder / "r.html");
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_EQ(content_of(html).at("results").at(0).at("result").at("remarks").at(0), evil);
}

}  // namespace
}  // namespace mosbench
