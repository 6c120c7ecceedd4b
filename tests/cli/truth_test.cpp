#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/truth_of_room.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class Truth : public TruthOfRoom {};

TEST_F(Truth, ProposesTracksAndSaysWhatIsLeft) {
  EXPECT_THAT(proposed_->out, HasSubstr("0 of them decided"));
  EXPECT_THAT(proposed_->out, HasSubstr("moving"));
  ASSERT_FALSE(tracks().empty());
  const cli::Answer status = cli::run({"truth", "status", truth()});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_EQ(status.out, proposed_->out);
}

TEST_F(Truth, WritesLabelsBeforeAnyDecisionThatScoreTakes) {
  const cli::Answer answer = write();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("0 decisions; labels in"));
  const std::size_t found = of_box(kMovingLabel);
  EXPECT_GT(found, 5000U);
  // The real truth beside the scans scores them as labels of any method.
  cli::write_small_sequence(folder_ / "room", kScans);
  const cli::Answer score =
      cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "own").string(),
                "--protocol", "mapmos", "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  EXPECT_EQ(nlohmann::json::parse(score.out).at("sequences").at(0).at("summary").at("tp"), found);
}

TEST_F(Truth, HeedsDecisionsAndSaysWhereLabelsComeFrom) {
  decide(box(), "static");
  EXPECT_EQ(write().exit_code, 0);
  EXPECT_EQ(of_box(kMovingLabel), 0U);
  decide(box(), "unsure");
  const cli::Answer answer = write();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("1 decision; labels in"));
  EXPECT_EQ(of_box(kMovingLabel), 0U);
  EXPECT_GT(of_box(0), 0U);
  const auto note = nlohmann::json::parse(read_file(folder_ / "own/room/labels/truth.json"));
  EXPECT_EQ(note.at("points").at("all"), kScans * cli::kPointsPerScan);
  EXPECT_GT(note.at("points").at("by_hand"), 0);
  EXPECT_EQ(note.at("decided").at(0).at("decided"), "unsure");
}

TEST_F(Truth, EstimatesTheIouOfLabelsFromDecisions) {
  const std::string run = (folder_ / "run").string();
  ASSERT_EQ(cli::run({"run", room(), "--method", "hmm-mos-plus", "--out", run}).exit_code, 0);
  const auto status = [&] { return cli::run({"truth", "status", truth(), run}); };
  EXPECT_THAT(status().out, testing::Not(HasSubstr("estimated"))) << "nothing is decided";
  nlohmann::json decisions = nlohmann::json::array();
  for (const nlohmann::json& track : tracks()) {
    const std::string id = "room/" + std::to_string(track.at("number").get<int>());
    decisions.push_back({{"track", id}, {"decided", id == box() ? "moving" : "static"}});
  }
  write_file_atomic(folder_ / "truth/decisions.json",
                    nlohmann::json{{"format", 1}, {"decisions", decisions}}.dump());
  EXPECT_THAT(status().out, HasSubstr("IoU if every track were decided, estimated"));
  const nlohmann::json answer =
      nlohmann::json::parse(cli::run({"truth", "status", truth(), run, "--json"}).out);
  const nlohmann::json rows = answer.at("sheets").at(1).at("rows");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("labels"), "as written now");
  EXPECT_EQ(rows[0].at("iou").at("value"), 1);

  // With every track decided it is what `score` says against the labels that are written.
  ASSERT_EQ(write().exit_code, 0);
  cli::write_small_sequence(folder_ / "room", kScans);
  std::filesystem::remove_all(folder_ / "room/labels");
  std::filesystem::copy(folder_ / "own/room/labels", folder_ / "room/labels");
  const cli::Answer score = cli::run({"score", (folder_ / "room").string(), "--predictions", run,
                                      "--protocol", "mapmos", "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  const nlohmann::json scored =
      nlohmann::json::parse(score.out).at("sequences").at(0).at("summary").at("iou");
  EXPECT_NEAR(rows[1].at("iou").at("value"), scored.get<double>(), 1e-12);
  EXPECT_EQ(rows[1].at("iou").at("low"), rows[1].at("iou").at("high"));
}

TEST_F(Truth, EstimatesNothingOfOtherResults) {
  decide(box(), "moving");
  cli::write_small_sequence(folder_ / "room", 12);
  const std::string run = (folder_ / "run").string();
  ASSERT_EQ(cli::run({"run", (folder_ / "room").string(), "--out", run}).exit_code, 0);
  const cli::Answer other = cli::run({"truth", "status", truth(), run});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("is of 12 scans, expected the 26 of "));
  const cli::Answer review = cli::run({"truth", "write", truth(), run});
  EXPECT_EQ(review.exit_code, 2);
  EXPECT_THAT(review.err, HasSubstr("RESULTS: are nothing for truth write"));
}

TEST_F(Truth, TellsDecisionsAgainstTheLooks) {
  auto list = nlohmann::ordered_json::parse(read_file(folder_ / "truth/tracks.json"));
  const std::string track = box();
  for (auto& told : list["tracks"]) told["doubt"] = 0.25;
  const auto status = [&] {
    write_file_atomic(folder_ / "truth/tracks.json", list.dump());
    return cli::run({"truth", "status", truth()}).out;
  };
  const std::string said = track + " is decided static, but 90 % of the looks at it say moving";
  decide(track, "static");
  EXPECT_THAT(status(), testing::Not(HasSubstr("look again")));
  for (auto& told : list["tracks"]) told["doubt"] = 0.1;
  EXPECT_THAT(status(), HasSubstr(said));
  decide(track, "moving");
  EXPECT_THAT(status(), testing::Not(HasSubstr("look again")));
}

TEST_F(Truth, IsTruthOfTheDriveForRunAndScore) {
  decide(box(), "moving");
  ASSERT_EQ(write().exit_code, 0);
  std::filesystem::copy(room(), folder_ / "room", std::filesystem::copy_options::recursive);
  std::filesystem::rename(folder_ / "own/room/labels", folder_ / "room/labels");
  const cli::Answer run = cli::run({"run", (folder_ / "room").string(), "--preset", "offline",
                                    "--out", (folder_ / "run").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("truth: 1 decision, 0.0 % unsure"));
  const cli::Answer score =
      cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "run").string()});
  EXPECT_THAT(score.out, HasSubstr("truth: 1 decision, 0.0 % unsure"));
  decide(box(), "unsure");
  ASSERT_EQ(write().exit_code, 0);
  std::filesystem::remove_all(folder_ / "room/labels");
  std::filesystem::rename(folder_ / "own/room/labels", folder_ / "room/labels");
  // The run calls the box moving: that may be all wrong, or all right.
  const std::string open = "unsure points leave 0.0 to 100.0 % IoU open, by mapmos";
  for (const char* as : {"text", "json"}) {
    const cli::Answer again =
        cli::run({"score", (folder_ / "room").string(), "--predictions", (folder_ / "run").string(),
                  "--protocol", "mapmos", "--as", as});
    EXPECT_THAT(again.out, HasSubstr(open)) << again.err;
  }
  const cli::Answer rerun =
      cli::run({"run", (folder_ / "room").string(), "--preset", "offline", "--protocol", "mapmos",
                "--out", (folder_ / "rerun").string()});
  EXPECT_THAT(rerun.out, HasSubstr(open)) << rerun.err;
  EXPECT_THAT(cli::run({"rank", (folder_ / "rerun").string()}).out, HasSubstr(open));
  write_file_atomic(folder_ / "room/labels/truth.json", "{}");
  const cli::Answer broken = cli::run({"convert", (folder_ / "room").string(), "--check"});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.err, HasSubstr("truth.json: has no \"doubt\", expected the file as "
                                    "`mosbench truth write` wrote it"));
}

TEST_F(Truth, KeepsDecisionsWhenProposedAgain) {
  decide(box(), "moving");
  const auto again = [&] { return cli::run({"truth", "propose", room(), "-o", truth()}); };
  const std::string before = read_file(folder_ / "truth/decisions.json");
  const cli::Answer kept = again();
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("1 of them decided"));
  EXPECT_EQ(read_file(folder_ / "truth/decisions.json"), before);
  std::filesystem::remove(folder_ / "truth/room/objects/000003.object");
  const cli::Answer lost = again();
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.err, HasSubstr("holds 1 decision on tracks whose files are not there any more"));
  EXPECT_EQ(read_file(folder_ / "truth/decisions.json"), before);
  std::filesystem::remove(folder_ / "truth/decisions.json");
  EXPECT_EQ(again().exit_code, 0) << "without decisions nothing is lost";
}

TEST_F(Truth, RefusesOtherDataAndLabelsOfOthers) {
  cli::write_small_sequence(folder_ / "other/room", kScans, 3);
  const cli::Answer other =
      cli::run({"truth", "write", truth(), "--out", (folder_ / "own").string(), "--data",
                (folder_ / "other").string()});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("was made from other scans, poses or labels"));
  EXPECT_FALSE(is_there(folder_ / "own/room/labels"));
  write_file_atomic(folder_ / "own/room/labels/000000.label", "mine");
  const cli::Answer replaced = write();
  EXPECT_EQ(replaced.exit_code, 2);
  EXPECT_THAT(replaced.err, HasSubstr("holds labels that `mosbench truth` did not write"));
  EXPECT_EQ(read_file(folder_ / "own/room/labels/000000.label"), "mine");
}

TEST_F(Truth, NamesWhatIsWrong) {
  decide("room/99999", "moving");
  const cli::Answer unknown = cli::run({"truth", "status", truth()});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err,
              HasSubstr("decisions.json: decides on \"room/99999\", expected a track"));
  const cli::Answer none = cli::run({"truth", "status", room()});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("has no tracks.json, expected a folder that `mosbench truth"));
  const cli::Answer flag = cli::run({"truth", "status", truth(), "--scans", "1:2"});
  EXPECT_EQ(flag.exit_code, 2);
  EXPECT_THAT(flag.err, HasSubstr("--scans 1:2: is nothing for truth status"));
  EXPECT_EQ(cli::run({"truth", "propose", room()}).exit_code, 2);
  EXPECT_EQ(cli::run({"truth", "write", truth()}).exit_code, 2);
}

TEST_F(Truth, ImportsWhatAnotherProgramCorrected) {
  ASSERT_EQ(write().exit_code, 0);
  const std::string own = (folder_ / "own").string();
  const auto import = [&] { return cli::run({"truth", "import", own, "-o", truth()}); };
  const cli::Answer same = import();
  ASSERT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("0 decisions by the labels in " + own + "; 0 of "));
  EXPECT_FALSE(is_there(folder_ / "truth/decisions.json"));
  // Nobody looked at one scan.
  const auto kept = written(19);
  write_labels(folder_ / "own/room/labels" / (cli::stem(19) + ".label"),
               std::vector<std::uint32_t>(kept.size()));
  EXPECT_THAT(import().out, HasSubstr("0 decisions by the labels in " + own + "; 0 of "));
  write_labels(folder_ / "own/room/labels" / (cli::stem(19) + ".label"), kept);
  // Somebody says that the box stands, but for 7 points, and writes one scan as a table.
  std::size_t left = 7;
  const auto file = [&](std::size_t scan, const char* extension) {
    return folder_ / "own/room/labels" / (cli::stem(scan) + extension);
  };
  for (std::size_t k = 0; k < kScans; ++k) {
    auto labels = written(k);
    std::string table = "label\n";
    for (std::uint32_t& label : labels) {
      if (label == kMovingLabel && (left == 0 || left-- == 0)) label = kStaticLabel;
      table += std::to_string(label) + '\n';
    }
    if (k != 20) write_labels(file(k, ".label"), labels);
    if (k == 20) write_file_atomic(file(k, ".csv"), table);
  }
  std::filesystem::remove(file(20, ".label"));
  const cli::Answer corrected = import();
  ASSERT_EQ(corrected.exit_code, 0) << corrected.err;
  EXPECT_THAT(corrected.out, HasSubstr("; 7 of "));
  EXPECT_THAT(corrected.out, HasSubstr("still differ: cut, split or paint tracks"));
  EXPECT_THAT(read_file(folder_ / "truth/decisions.json"), HasSubstr(box()));
  std::filesystem::rename(folder_ / "own", folder_ / "corrected");
  ASSERT_EQ(write().exit_code, 0);
  EXPECT_EQ(of_box(kMovingLabel), 0U);
  std::filesystem::copy(folder_ / "corrected/room/labels/000020.csv", file(20, ".csv"));
  std::filesystem::remove(file(20, ".label"));
  std::string moved = "x,y,z,label\n900,0,0,9\n";
  for (std::size_t i = 1; i < cli::kPointsPerScan; ++i) moved += "0,0,0,9\n";
  write_file_atomic(file(20, ".csv"), moved);
  const cli::Answer other = import();
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("000020.csv: point 0 is not where it is in the scan"));
  std::filesystem::remove(file(20, ".csv"));
  const cli::Answer none = import();
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("has no labels of scan 000020, expected a file of them"));
  EXPECT_EQ(cli::run({"truth", "import", own}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
