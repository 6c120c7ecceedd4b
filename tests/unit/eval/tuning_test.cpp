#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/job/study_drives.hpp"
#include "eval/job/study_file.hpp"
#include "eval/job/tuned_preset.hpp"
#include "eval/study/study_table.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kTuningStudy = R"(name: tuning
protocol: semantickitti-mos
data:
  - name: room
    simulate: {layout: semantickitti, scene: room, scans: 6, seed: [1, 2, 3]}
methods:
  - {method: hmm-mos, set: {min_range_m: 1}}
  - {name: near, method: underwood}
grid: {max_range_m: [10, 20], local_window_scans: [3, 2]}
best_of: {metric: iou, tune_on: [room-1, room-2], judge_on: [room-3]}
)";

std::string tuning_with(const std::string& what, const std::string& by) {
  std::string text = kTuningStudy;
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

void enter_score(PlannedCell& planned, double iou) {
  const auto moving = static_cast<std::uint64_t>(std::llround(1000 * iou));
  planned.state = CellState::kDone;
  planned.numbers = {};
  planned.numbers.counts = {Confusion{.tp = moving, .fp = 1000 - moving}};
  planned.numbers.metrics = {iou, iou, 1.0};
  planned.numbers.fingerprint = "of " + planned.cell.sequence_label();
}

TunedPreset read_back(const TunedPreset& preset) {
  const TempFolder folder;
  folder.write("p.json", to_json(preset).dump());
  return read_tuned_preset(folder / "p.json");
}

/// The plan of the study with IoUs by what a cell sets, and less in later sequences.
struct ScoredTuning {
  explicit ScoredTuning(const std::string& text = kTuningStudy)
      : study(parse_study(text, "s.yaml")), plan(plan_study(study, folder.path())) {
    for (PlannedCell& planned : plan.cells) {
      const auto& changes = planned.cell.job.segment.changes;
      const std::string set = to_words(changes);
      double iou = 0.5;
      if (set.find("max_range_m=20") != std::string::npos) iou += 0.2;
      if (set.find("local_window_scans=2") != std::string::npos) iou += 0.1;
      if (planned.cell.data->name == "room-3") iou = 0.9 - iou / 2;
      enter_score(planned, iou);
    }
  }
  PlannedCell& cell(const std::string& title) {
    for (PlannedCell& planned : plan.cells) {
      if (planned.cell.title() == title) return planned;
    }
    throw std::runtime_error("no cell " + title);
  }

  TempFolder folder;
  Study study;
  StudyPlan plan;
};

TEST(StudyGrid, HoldsAllCombinationsInOrder) {
  const Study study = parse_study(kTuningStudy, "s.yaml");
  ASSERT_EQ(study.axes.size(), 1U);
  EXPECT_EQ(study.axes[0].values,
            (std::vector<std::string>{
                "max_range_m=10,local_window_scans=3", "max_range_m=10,local_window_scans=2",
                "max_range_m=20,local_window_scans=3", "max_range_m=20,local_window_scans=2"}));
  const TempFolder folder;
  // Underwood has no windows: two combinations, and the preset's.
  EXPECT_EQ(plan_study(study, folder.path()).cells.size(), 3U * (5 + 3));
  const auto error = [](const std::string& what, const std::string& by) {
    return message_of<UsageError>([&] { parse_study(tuning_with(what, by), "s.yaml"); });
  };
  EXPECT_THAT(error("[10, 20]", "[10, many]"), StartsWith("s.yaml:9: "));
  EXPECT_THAT(error("max_range_m: [10", "max_rang_m: [10"),
              AllOf(StartsWith("s.yaml:9: "), HasSubstr("no method has a setting")));
  EXPECT_THAT(error("{max_range_m: [10, 20], local_window_scans: [3, 2]}", "{}"),
              StartsWith("s.yaml:9: is an empty map"));
}

TEST(StudyTuningFile, IsRefusedWhereItWouldCheat) {
  const TempFolder folder;
  const auto error = [&](const std::string& what, const std::string& by) {
    return message_of<UsageError>([&] {
      const Study study = parse_study(tuning_with(what, by), "s.yaml");
      plan_study(study, folder.path());
    });
  };
  for (const char* both : {"[room-2]", "[room]", "[\"08\"]", "[room-2 08]", "[room 08]"}) {
    EXPECT_THAT(error("judge_on: [room-3]", std::string("judge_on: ") + both),
                AllOf(HasSubstr("s.yaml: best_of tunes and judges on sequence \"room-"),
                      HasSubstr("expected others in judge_on")))
        << both;
  }
  EXPECT_THAT(error("[room-3]", "[mall]"),
              HasSubstr("best_of names \"mall\", which is no sequence of the study, expected some "
                        "of room-1 08, room-2 08, room-3 08"));
  EXPECT_THAT(error("[room-3]", "[]"), StartsWith("s.yaml:10: is an empty list"));
  EXPECT_THAT(error(", judge_on: [room-3]", ""), HasSubstr("\"judge_on\" is missing"));
  EXPECT_THAT(error("metric: iou", "metric: f7"),
              HasSubstr("metric \"f7\" is not known, expected one of iou, precision, recall"));
  EXPECT_THAT(error("grid: {max_range_m: [10, 20], local_window_scans: [3, 2]}\n", ""),
              HasSubstr("best_of chooses among nothing"));
}

TEST(StudyTuningChoice, IsTheBestOfTuneOnAndJudgedElsewhere) {
  const ScoredTuning scored;
  const StudyTable table = gather(scored.plan);
  ASSERT_EQ(table.choices.size(), 2U);
  const StudyChoice& choice = table.choices[0];
  ASSERT_TRUE(choice.preset) << choice.why_none;
  EXPECT_EQ(to_words(choice.preset->settings), "min_range_m=1,max_range_m=20,local_window_scans=2");
  EXPECT_EQ(choice.candidates, 4U);
  EXPECT_NEAR(*(*choice.chosen.tuned)[0].value, 0.8, 1e-9);
  EXPECT_NEAR(*(*choice.chosen.judged)[0].value, 0.5, 1e-9) << "worse there than all others";
  EXPECT_NEAR(*(*choice.base.tuned)[0].value, 0.5, 1e-9);
  EXPECT_NEAR(*(*choice.base.judged)[0].value, 0.65, 1e-9);
  EXPECT_EQ(table.choices[1].candidates, 2U);
  EXPECT_EQ(to_words(table.choices[1].preset->settings), "max_range_m=20")
      << "underwood has no windows";
  const std::string text = render(study_answer(scored.plan, table), Format::kText);
  EXPECT_THAT(text, AllOf(HasSubstr("IoU % by grid, on tune_on"), HasSubstr("tuned IoU %"),
                          HasSubstr("judged IoU %"), HasSubstr("default of preset semantickitti"),
                          HasSubstr("tuned on room-1 08, room-2 08 by iou (study tuning)")));
}

TEST(StudyTuningChoice, TakesTheFirstOfEquals) {
  ScoredTuning scored;
  for (PlannedCell& planned : scored.plan.cells) enter_score(planned, 0.5);
  EXPECT_EQ(to_words(gather(scored.plan).choices[0].preset->settings),
            "min_range_m=1,max_range_m=10,local_window_scans=3");
}

TEST(StudyTuningChoice, WaitsForTheCellsOfTuneOnAlone) {
  ScoredTuning scored;
  const std::string grid = ", hmm-mos, grid=max_range_m=";
  scored.cell("room-3 08" + grid + "20,local_window_scans=2").state = CellState::kMissing;
  StudyTable table = gather(scored.plan);
  ASSERT_TRUE(table.choices[0].preset);
  EXPECT_FALSE(table.choices[0].chosen.judged);
  EXPECT_TRUE(table.choices[0].chosen.tuned);
  scored.cell("room-2 08" + grid + "10,local_window_scans=3").state = CellState::kMissing;
  table = gather(scored.plan);
  EXPECT_FALSE(table.choices[0].preset);
  EXPECT_EQ(table.choices[0].why_none, "1 cell of tune_on is missing");
  EXPECT_THAT(render(study_answer(scored.plan, table), Format::kText),
              HasSubstr("room-2 08" + grid + "10,local_window_scans=3"));
}

TEST(StudyTuningChoice, PassesOverWhatFails) {
  ScoredTuning scored;
  scored.cell("room-1 08, hmm-mos, grid=max_range_m=20,local_window_scans=2").state =
      CellState::kFailed;
  const StudyTable table = gather(scored.plan);
  EXPECT_EQ(to_words(table.choices[0].preset->settings),
            "min_range_m=1,max_range_m=20,local_window_scans=3");
  EXPECT_EQ(table.choices[0].passed_over, 1U);
  EXPECT_THAT(render(study_answer(scored.plan, table), Format::kText),
              HasSubstr("hmm-mos: 1 of 4 combinations passed over"));
}

TEST(TunedPresets, AreReadAsTheyAreWritten) {
  const ScoredTuning scored;
  const auto choices = gather(scored.plan).choices;
  write_presets(choices);
  const auto file = scored.folder / "hmm-mos.preset.json";
  const TunedPreset read = read_tuned_preset(file);
  EXPECT_EQ(read.method->name, "hmm-mos");
  EXPECT_EQ(read.base->name, "semantickitti");
  EXPECT_EQ(read.settings, choices[0].preset->settings);
  EXPECT_EQ(to_json(read), to_json(*choices[0].preset));
  EXPECT_EQ(read.title(), choices[0].preset->title());
  ASSERT_EQ(read.tuned_on.size(), 2U);

  Result result;
  result.dataset = "semantickitti";
  result.sequence = SequenceName("08", file);
  result.from.fingerprint_without_poses = "of room-2 08";
  const auto doubt = [&](const TunedPreset& preset, const std::set<std::uint64_t>& scans = {}) {
    return tuning_doubt(preset, result, scans);
  };
  EXPECT_THAT(doubt(read), HasSubstr("tuned on this sequence: "));
  result.from.fingerprint_without_poses = "of another part";
  EXPECT_THAT(doubt(read), HasSubstr("tuned on a sequence of this name: "));
  TunedPreset known = read;
  for (TunedSequence& one : known.tuned_on) one.scans = {1, 2};
  EXPECT_EQ(read_back(known).tuned_on[1].scans, known.tuned_on[1].scans);
  EXPECT_THAT(doubt(known), HasSubstr("tuned on a sequence of this name: "));
  EXPECT_EQ(doubt(known, {3}), "") << "another drive of this name";
  result.sequence = SequenceName("09", file);
  EXPECT_EQ(doubt(read), "");
  EXPECT_THAT(doubt(known, {2, 3}), HasSubstr("tuned on this sequence: "));
  TunedPreset simulated = read;
  result.from.simulated = SimulatedOrigin{"doals", "room", "f", 9, 5};
  EXPECT_EQ(doubt(simulated), "");
  simulated.tuned_on[0].simulation = drive_of(result.from.simulated);
  EXPECT_THAT(doubt(simulated), HasSubstr("tuned on a sequence of this simulation: "));
  result.from.simulated->seed = 6;
  EXPECT_THAT(doubt(simulated), HasSubstr("tuned on another seed of this scene: "));
  result.from.simulated->scene_fingerprint = "g";
  EXPECT_EQ(doubt(simulated), "");
}

/// Scans of other numbers of points, or all of as many, each point so far from where it would be.
std::set<std::uint64_t> hashes_of_drive(bool counts_differ, float noise_m, std::size_t first = 0) {
  const TempFolder folder;
  constexpr std::size_t kScans = 20;
  for (std::size_t k = 0; k < kScans; ++k) {
    std::vector<Point> points(counts_differ ? 9 + (k + first) * 7 % 23 : 9);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = {static_cast<float>(5 + i) + noise_m, static_cast<float>(k + first), 0, 0};
    }
    write_bin(folder / fmt::format("velodyne/{:06}.bin", k), points);
  }
  write_poses(folder / "poses.txt", std::vector<Pose>(kScans, Pose::Identity()));
  return scan_hashes({.path = folder.path()}, folder.path().filename());
}

TEST(ScanHashes, KnowACopyWhosePointsHaveNoiseByTheirNumbers) {
  const auto drive = hashes_of_drive(true, 0);
  EXPECT_TRUE(share_a_scan(drive, hashes_of_drive(true, 0.01F)));
  EXPECT_TRUE(share_a_scan(drive, hashes_of_drive(true, 0.01F, 4))) << "a later part";
  const auto organised = hashes_of_drive(false, 0);
  EXPECT_TRUE(share_a_scan(organised, hashes_of_drive(false, 0)));
  EXPECT_FALSE(share_a_scan(organised, hashes_of_drive(false, 0.01F)));
}

TEST(TunedPresets, AreRefusedWithTheirFile) {
  const TempFolder folder;
  const auto error = [&](const std::string& text) {
    folder.write("p.json", text);
    return message_of<UsageError>([&] { read_tuned_preset(folder / "p.json"); });
  };
  const std::string rest =
      R"(, "preset": null, "settings": {"max_range_m": 9}, "metric": "iou", "study": "s", "tuned_on": []})";
  folder.write("p.json", R"({"method": "yoon")" + rest);
  EXPECT_EQ(read_tuned_preset(folder / "p.json").base, nullptr);
  EXPECT_THAT(error("{"), HasSubstr("p.json"));
  EXPECT_THAT(error("{}"), HasSubstr("p.json: is no preset, expected a file that a study with"));
  EXPECT_THAT(error(R"({"method": "yooon")" + rest),
              AllOf(HasSubstr("p.json: "), HasSubstr("nearest: yoon")));
  EXPECT_THAT(error(R"({"method": "yoon")" +
                    std::string(rest).replace(rest.find("max_range_m"), 11, "max_rang_m")),
              HasSubstr("nearest: max_range_m"));
}

}  // namespace
}  // namespace mosbench
