#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mosbench/method.hpp>
#include <set>
#include <string>
#include <vector>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/engine/window_remark.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/tell.hpp"
#include "eval/store/store.hpp"
#include "eval/tables/score_report.hpp"
#include "tests/unit/eval/confusions.hpp"

namespace mosbench {
namespace {

TEST(ChangedMembers, NameWhatDiffersOnEitherSide) {
  const nlohmann::ordered_json first = {
      {"a", 1}, {"b", {{"c", 2.5}, {"d", "x"}, {"f", 1}}}, {"gone", {}}};
  const nlohmann::ordered_json second = {{"a", 1}, {"b", {{"c", 3.5}, {"d", "x"}}}, {"e", true}};
  EXPECT_EQ(changed_members(first, second),
            "b/c is 2.5 there and 3.5 now; e is nothing there and true now; b/f is 1 there and "
            "nothing now");
  EXPECT_EQ(changed_members(second, second), "");
  const nlohmann::ordered_json empty = nlohmann::ordered_json::object();
  EXPECT_EQ(changed_members(empty, empty), "");
  EXPECT_EQ(changed_members(empty, {{"a", 1}}), "a is nothing there and 1 now");
}

TEST(WindowRemark, SaysHowLongWindowsInScansLastHere) {
  const Settings plain = find_method("hmm-mos")->defaults;
  EXPECT_EQ(window_remark(plain, 0.1), "");
  EXPECT_EQ(window_remark(plain, 0.119), "") << "a sweep that wavers";
  EXPECT_EQ(window_remark(plain, std::nullopt), "") << "no window of it is in seconds";
  EXPECT_EQ(window_remark(plain, 0.2),
            "scans come every 0.2 s, not every 0.1 s: local_window_scans=3 lasts 0.6 s, "
            "global_window_scans=300 lasts 60 s, dynamic_window_scans=100 lasts 20 s, "
            "distance_field_scans=2 lasts 0.4 s");
  const Settings plus = find_method("hmm-mos-plus")->defaults;
  EXPECT_EQ(window_remark(plus, std::nullopt),
            "scans have no stamps: seed_age_s, object_age_s, fresh_age_s are counted as at 10 Hz");
  EXPECT_EQ(window_remark(plus, 0.05),
            "scans come every 0.05 s, not every 0.1 s: global_window_scans=300 lasts 15 s, "
            "seed_age_s, object_age_s, fresh_age_s by the stamps");
}

TEST(ReadingJson, KeepsWhatTheUserTold) {
  const Reading told = {.scans = parse_scan_range("10:60:5"),
                        .poses = PoseFile{"/somewhere/p.csv"},
                        .pose_format = PoseFormat::kTum,
                        .pose_frame = PoseFrame::kCamera,
                        .pose_direction = PoseDirection::kMapFromSensor,
                        .max_pose_gap_s = 1.5,
                        .pose_offset_s = -0.25,
                        .topic = "/os1",
                        .map_frame = "map",
                        .pose_topic = "/gps",
                        .deskew = Deskew::kVelocity,
                        .point_times = PointTimes::kColumn,
                        .moving_speed_m_s = 0.75,
                        .bin_columns = 5,
                        .hdl64_correction = true};
  const nlohmann::ordered_json json = told_json(told);
  const Reading read = told_from_json(json);
  EXPECT_EQ(to_string(read.scans.value()), "10:60:5");
  EXPECT_EQ(*read.pose_file(), *told.pose_file());
  EXPECT_EQ(read.pose_format, told.pose_format);
  EXPECT_EQ(read.pose_frame, told.pose_frame);
  EXPECT_EQ(read.pose_direction, told.pose_direction);
  EXPECT_EQ(read.max_pose_gap_s, told.max_pose_gap_s);
  EXPECT_EQ(read.pose_offset_s, told.pose_offset_s);
  EXPECT_EQ(read.topic, told.topic);
  EXPECT_EQ(read.map_frame, told.map_frame);
  EXPECT_EQ(read.pose_topic, told.pose_topic);
  EXPECT_EQ(read.deskew, told.deskew);
  EXPECT_EQ(read.point_times, told.point_times);
  EXPECT_EQ(told_from_json(told_json({.deskew = Deskew::kNone})).deskew, Deskew::kNone);
  EXPECT_EQ(read.bin_columns, told.bin_columns);
  EXPECT_EQ(read.moving_speed_m_s, told.moving_speed_m_s);
  EXPECT_EQ(read.hdl64_correction, told.hdl64_correction);
  EXPECT_EQ(told_json(read), json);
  EXPECT_TRUE(told_json({}).empty());
  EXPECT_TRUE(told_json(told_from_json({{"file_stamp", "ab"}})).empty());
}

TEST(ReadingJson, RefusesWordsItDoesNotKnow) {
  for (const char* key : {"pose_format", "pose_frame", "pose_direction", "deskew", "point_times"}) {
    EXPECT_THROW(told_from_json({{key, "sideways"}}), UsageError) << key;
  }
}

TEST(ReadingJson, RefusesColumnsThatNoScanFileHas) {
  for (const char* columns : {"0", "1", "-4", "4.5", "\"5\"", "null", "4611686018427387904"}) {
    const auto json = nlohmann::ordered_json::parse(columns);
    EXPECT_THROW(told_from_json({{"bin_columns", json}}), UsageError) << columns;
  }
}

TEST(DurationText, ChangesItsUnitWithTheLength) {
  EXPECT_EQ(duration_text(0.2), "0 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(185.0), "3 min 05 s");
  EXPECT_EQ(duration_text(7620.0), "2 h 07 min");
}

ScanRow scan_row(const char* stem, const std::optional<Confusion>& counts) {
  ScanRow row;
  row.stem = stem;
  row.counts = counts;
  return row;
}

const std::vector<ScanRow> kScansOfA = {scan_row("0", counts(1, 0, 1)), scan_row("1", {}),
                                        scan_row("2", counts(3, 1, 0))};
const std::vector<ScanRow> kScansOfB = {scan_row("0", counts(90, 5, 5))};
const std::vector<ScoredSequence> kTwoSequences = {{"a", kScansOfA, 10.0}, {"b", kScansOfB, 30.0}};

TEST(ScoreRows, PoolASplitOverItsSequences) {
  const Split split{"test", {{0, std::nullopt}, {1, std::nullopt}}};
  const auto rows = summary_rows(protocol_named("sipailou"), {split}, kTwoSequences);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_DOUBLE_EQ(rows[0].summary[Metric::kIou].value(), 4.0 / 6.0);
  EXPECT_EQ(rows[0].scans, 3U);
  EXPECT_EQ(rows[0].summary.scans, 2U);
  EXPECT_EQ(rows[2].kind, SummaryRow::Kind::kSplit);
  EXPECT_DOUBLE_EQ(rows[2].summary[Metric::kIou].value(), 94.0 / 106.0);
  EXPECT_DOUBLE_EQ(rows[2].method_ms_per_scan.value(), 15.0);
}

TEST(ScoreRows, AverageSensorsWhereTheProtocolDoes) {
  const Split split{"test", {{0, std::set<std::string>{"2"}}, {1, std::nullopt}}};
  const auto rows = summary_rows(protocol_named("helimos-test"), {split}, kTwoSequences);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[2].kind, SummaryRow::Kind::kPart);
  EXPECT_DOUBLE_EQ(rows[2].summary[Metric::kIou].value(), 0.75);
  EXPECT_DOUBLE_EQ(rows[0].summary[Metric::kIou].value(), 0.75) << "of the scans of the split";
  EXPECT_EQ(rows[0].split, "test");
  EXPECT_DOUBLE_EQ(rows[3].summary[Metric::kIou].value(), (0.75 + 0.9) / 2.0);
}

TEST(ScoreRows, CoverWholeSequencesWhereTheSplitPicksNone) {
  const Split whole{"test", {{0, std::nullopt}}};
  const Split picked{"test", {{0, std::set<std::string>{"2"}}}};
  EXPECT_EQ(summary_rows(protocol_named("helimos-test"), {whole}, kTwoSequences)[0].split, "");
  EXPECT_EQ(summary_rows(protocol_named("helimos-all"), {picked}, kTwoSequences)[0].split, "");
  const auto rows = summary_rows(protocol_named("helimos-test"), {picked}, kTwoSequences);
  EXPECT_EQ(rows[1].scans, 0U) << "sequence b has no scan in the split";
}

TEST(BenchmarkNotice, SaysWhichRowHoldsTheNumberOrThatNoneDoes) {
  const Split split{"test", {{0, std::nullopt}}};
  EXPECT_EQ(benchmark_remark(protocol_named("sipailou"), {split}),
            "the benchmark's number is that of split test");
  const Split other{"valid", {{0, std::nullopt}}};
  EXPECT_THAT(benchmark_remark(protocol_named("sipailou"), {other}),
              testing::StartsWith("no row is the benchmark's number"));
  EXPECT_EQ(benchmark_remark(protocol_named("sipailou"), {}), "") << "sequences of no benchmark";
  EXPECT_EQ(benchmark_remark(protocol_named("helimos-all"), {}), "");
}

TEST(ScoreRows, WithoutTruthShowNoNumber) {
  const Protocol& protocol = protocol_named("sipailou");
  const std::vector<ScanRow> scans = {scan_row("0", {})};
  const auto rows = summary_rows(protocol, {}, {{"a", scans, std::nullopt}});
  EXPECT_THAT(text_of(score_sheet({&protocol, {}}, {}, rows)), testing::HasSubstr("no truth"));
  EXPECT_TRUE(rows_json(rows).at("sequences").at(0).at("summary").is_null());
}

}  // namespace
}  // namespace mosbench
