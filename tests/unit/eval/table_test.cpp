#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/tables/table_print.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/eval/table_runs.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Published, HoldsTheTablesWithTheirSources) {
  EXPECT_GT(published().size(), 150U);
  for (const PublishedCell& cell : published()) {
    EXPECT_FALSE(cell.protocol.empty()) << cell.table << cell.method;
    EXPECT_FALSE(cell.source.empty()) << cell.table << cell.method;
    EXPECT_GT(cell.iou(), 0.0);
    EXPECT_LT(cell.iou(), 1.0);
    const auto& columns = paper_table_named(cell.table).columns;
    EXPECT_THAT(columns, Contains(testing::Field(&TableColumn::name, cell.column)));
  }
}

TEST(Published, RefusesWhatIsNoTable) {
  const std::string text =
      "table,section,method,setting,variant,voxel_size_m,max_range_m,delay_scans,column,"
      "iou_percent,protocol,source,note\n";
  EXPECT_THAT(parse_published(text + "I,,m,s,,,,,ST,50,p,s,\n", "f.csv"), testing::SizeIs(1));
  EXPECT_THAT(message_of<DataError>([&] { parse_published("a,b\n", "f.csv"); }),
              HasSubstr("f.csv:1: has another header"));
  EXPECT_THAT(message_of<DataError>([&] { parse_published(text + "I,x\n", "f.csv"); }),
              HasSubstr("has 2 cells"));
  EXPECT_THAT(
      message_of<DataError>([&] { parse_published(text + "I,,m,s,,,,,ST,much,p,s,\n", "f.csv"); }),
      HasSubstr("says \"much\""));
}

// The average of HeLiMOS's published rows is that of their four sensors.
TEST(Published, AgreesWithItsAverages) {
  std::size_t checked = 0;
  for (const PublishedRow& row : published_rows(paper_table_named("III"), published())) {
    if (row.cells.size() != 5) continue;
    const double mean =
        (row.cells[0].iou() + row.cells[1].iou() + row.cells[2].iou() + row.cells[3].iou()) / 4.0;
    EXPECT_NEAR(mean, row.cells[4].iou(), 0.00101) << row.cells[0].method;
    ++checked;
  }
  EXPECT_EQ(checked, 6U);
}

TEST(FillTable, SaysWithinWhereThePublishedValueLiesInTheInterval) {
  const TableCell cell = cell_of(filled({station(889)}));
  EXPECT_EQ(cell.verdict, Verdict::kWithin) << testing::PrintToString(cell.reasons);
  EXPECT_NEAR(cell.measured->value.value(), 0.889, 1e-12);
  EXPECT_NEAR(cell.difference.value(), 0.0, 1e-12);
  EXPECT_EQ(cell.published->iou_percent, "88.9");
  EXPECT_THAT(cell.reasons, IsEmpty());
}

TEST(FillTable, ComparesNoDisturbedScansWithPublishedOnes) {
  ResultSet run = station(889);
  run.sequences[1].from.reading = {{"perturb", "beams=32,beams_of=64,seed=1"}};
  const TableCell cell = cell_of(filled({run}));
  EXPECT_EQ(cell.verdict, Verdict::kNotComparable);
  EXPECT_TRUE(cell.is_apart);
  EXPECT_THAT(cell.reasons, testing::ElementsAre("sequence station/sequence_2 is disturbed by "
                                                 "beams=32,beams_of=64,seed=1"));
}

TEST(FillTable, SaysOutsideWhereItDoesNot) {
  const TableCell cell = cell_of(filled({valid(880)}, "II"));
  EXPECT_EQ(cell.verdict, Verdict::kOutside) << testing::PrintToString(cell.reasons);
}

TEST(FillTable, JudgesTheTwentyScansOfTableI) {
  EXPECT_EQ(cell_of(filled({station(885)})).verdict, Verdict::kWithin);
  const TableCell cell = cell_of(filled({station(860)}));
  EXPECT_EQ(cell.verdict, Verdict::kOutside) << testing::PrintToString(cell.reasons);
  EXPECT_LT(cell.measured->interval.value().high, 0.889);
}

TEST(FillTable, JudgesNoDifferenceWhereScansAreTooFewForAnInterval) {
  const TableCell cell = cell_of(filled({station(860, 1)}));
  EXPECT_EQ(cell.verdict, Verdict::kNotComparable);
  EXPECT_THAT(cell.reasons, testing::ElementsAre(HasSubstr("no interval: 20 scans")));
}

/// The published value stands beside it, because both are of the same scans by the same rules.
TEST(FillTable, JudgesNoDifferenceOfOtherSettings) {
  ResultSet coarse = station(889);
  for (Result& part : coarse.sequences) part.settings->set("voxel_size_m", 0.3);
  const TableCell cell = cell_of(filled({coarse}));
  EXPECT_EQ(cell.verdict, Verdict::kNotComparable);
  EXPECT_EQ(cell.published.value().iou_percent, "88.9");
  EXPECT_THAT(cell.reasons, ElementsAre("voxel size in m 0.3, published 0.2"));
}

TEST(FillTable, SaysHowToFillWhatIsEmpty) {
  for (const PaperTable& table : paper_tables()) {
    const FilledTable empty = fill_table(table, published(), {});
    ASSERT_FALSE(empty.rows.empty()) << table.name;
    for (const TableRow& row : empty.rows) {
      for (const TableCell& cell : row.cells) {
        EXPECT_EQ(cell.verdict, Verdict::kPublishedOnly);
        if (!row.method.starts_with("HMM-MOS")) continue;
        EXPECT_THAT(cell.reasons.front(), testing::ContainsRegex("mosbench |no variant"));
      }
    }
  }
  const TableCell shopville = cell_of(filled({station(889)}), 1);
  EXPECT_EQ(shopville.verdict, Verdict::kPublishedOnly);
  EXPECT_THAT(shopville.reasons.front(), HasSubstr("shopville/sequence_1"));
}

TEST(FillTable, TakesRowsOfAnyMethod) {
  ResultSet dynablox = station(800);
  ResultSet own = station(700);
  for (Result& part : dynablox.sequences) {
    part.method = "Dynablox";
    part.setting = "";
    part.protocol = &protocol_named("doals-dynablox");
  }
  for (Result& part : own.sequences) part.method = "Mine";
  const FilledTable table = filled({dynablox, own});
  const TableRow& last = table.rows.back();
  EXPECT_EQ(last.method, "Mine");
  EXPECT_EQ(last.cells[0].verdict, Verdict::kMeasuredOnly);
  EXPECT_THAT(table.rows,
              Contains(testing::AllOf(testing::Field(&TableRow::method, "Dynablox"),
                                      testing::Field(&TableRow::results, "runs/doals"))));
}

/// It was published nowhere and is no row of the paper's.
TEST(FillTable, HasARowOfPresetBestWhichIsNeverThePapers) {
  for (const char* name : {"I", "II", "III"}) {
    const TableRow row = filled({}, name).rows.back();
    EXPECT_EQ(row.method, "HMM-MOS plus");
    for (const TableCell& cell : row.cells) {
      EXPECT_FALSE(cell.published);
      EXPECT_THAT(cell.reasons, ElementsAre(HasSubstr("--preset best")));
    }
  }
  ResultSet plus = station(889);
  for (Result& part : plus.sequences) part.method = "HMM-MOS plus";
  const FilledTable table = filled({plus});
  std::size_t rows = 0;
  for (const TableRow& row : table.rows) {
    if (row.method != "HMM-MOS plus") {
      EXPECT_EQ(row.results, "");
      continue;
    }
    ++rows;
    EXPECT_EQ(row.results, "runs/doals");
    EXPECT_EQ(row.section, "");
    EXPECT_EQ(row.cells[0].verdict, Verdict::kMeasuredOnly);
  }
  EXPECT_EQ(rows, 1U);
}

/// Two ranges of the paper's table differ in no other setting.
TEST(FillTable, PutsRunsOfPeersBesideThePublishedCellsOfTheirRange) {
  for (const auto& [range_m, section] :
       {std::pair{20.0, "range 20 m"}, std::pair{120.0, "full range"}}) {
    ResultSet run = station(880);
    for (Result& part : run.sequences) {
      part.method = "Dynablox";
      part.protocol = &protocol_named("doals-dynablox");
      part.settings =
          recorded_settings({{"level", "object"}, {"voxel_size_m", 0.2}, {"max_range_m", range_m}});
    }
    const FilledTable table = filled({run});
    const auto row = std::ranges::find(table.rows, "runs/doals", &TableRow::results);
    ASSERT_NE(row, table.rows.end());
    EXPECT_EQ(row->section, section);
    EXPECT_EQ(row->protocol, "doals-dynablox");
    EXPECT_THAT(row->cells[0].reasons, IsEmpty());
    EXPECT_EQ(row->cells[0].published->iou_percent, range_m < 100 ? "87.3" : "86.2");
    EXPECT_EQ(row->cells[0].verdict, Verdict::kOutside);
    for (Result& part : run.sequences) part.settings->set("level", "point");
    EXPECT_THAT(cell_of(filled({run})).reasons, ElementsAre("level point, published object"));
  }
}

TEST(FillTable, SaysHowToRunPeersThatMosbenchHas) {
  const FilledTable table = filled({});
  std::size_t found = 0;
  for (const TableRow& row : table.rows) {
    if (row.method != "Dynablox") continue;
    ++found;
    const bool near = row.section == "range 20 m";
    EXPECT_THAT(row.cells[0].reasons.front(),
                HasSubstr(std::string("mosbench run DIR --dataset doals --sequences "
                                      "station/sequence_1,station/sequence_2 --preset ") +
                          (near ? "doals-20m" : "doals-120m") +
                          " --method dynablox --protocol doals-dynablox --out results/runs/" +
                          (near ? "doals-20m" : "doals-120m") + "-dynablox-doals-dynablox"));
  }
  EXPECT_EQ(found, 2U);
}

/// MOE's page names no setting of the methods that it lists.
TEST(FillTable, ComparesNothingWithAPeerWhoseSettingsAreNotStated) {
  ResultSet run{"runs/moe", {sequence("00", 40, 400)}};
  run.sequences[0].dataset = "moe";
  run.sequences[0].method = "OctoMap";
  run.sequences[0].protocol = &protocol_named("moe");
  run.sequences[0].settings = recorded_settings({{"voxel_size_m", 0.2}, {"max_range_m", 120.0}});
  const TableCell cell = cell_of(filled({run}, "moe"));
  EXPECT_EQ(cell.published.value().iou_percent, "32.8");
  EXPECT_EQ(cell.verdict, Verdict::kNotComparable);
  EXPECT_THAT(cell.reasons, Contains("the settings of the published run are not stated"));
}

TEST(FillTable, AveragesSensorsAndCountsBothFrameSetsOfHelimos) {
  ResultSet run{"runs/helimos", {}};
  for (const auto& [name, found] : {std::pair{"Aeva", 500U}, std::pair{"Avia", 600U},
                                    std::pair{"Ouster", 700U}, std::pair{"Velodyne", 400U}}) {
    Result part = sequence(name, 40, found);
    part.dataset = "helimos";
    part.protocol = &protocol_named("helimos-all");
    part.settings->set("voxel_size_m", 0.25);
    part.settings->set("max_range_m", 50.0);
    part.splits["test"] = {"1", "3"};
    run.sequences.push_back(part);
  }
  const FilledTable table = filled({run}, "III");
  std::vector<double> averages;
  for (const TableRow& row : rows_of_runs(table, true)) {
    averages.push_back(row.cells.at(4).measured->value.value());
  }
  ASSERT_EQ(averages.size(), 2U);
  EXPECT_NEAR(averages[0], 0.55, 1e-12);
  EXPECT_NEAR(averages[1], 0.56, 1e-12) << "the odd scans find 10 points more";
  EXPECT_EQ(table.rows.size(), 11U)
      << "nine published ones, one of them measured, two apart and that of preset best";
}

TEST(TablePrint, GivesEachFormatTheSameNumbers) {
  const FilledTable table = filled({valid(880)}, "II");
  const Answer answer = table_answer(table);
  EXPECT_THAT(render(answer, Format::kMarkdown), HasSubstr("85.6 / 88.0 (+2.4) [8"));
  EXPECT_THAT(render(answer, Format::kMarkdown), HasSubstr("] outside |"));
  EXPECT_THAT(render(answer, Format::kLatex), HasSubstr("85.6 / 88.0 (+2.4)"));
  EXPECT_THAT(render(answer, Format::kLatex), HasSubstr("\\begin{tabular}{lllrr}"));
  EXPECT_THAT(render(answer, Format::kCsv), HasSubstr(",sipailou,valid,85.6,87.999"));
  const auto json = to_json(table);
  EXPECT_EQ(json.at("columns").size(), 2U);
  for (const auto& row : json.at("rows")) {
    if (row.at("results") == "") continue;
    EXPECT_EQ(row.at("cells").at(0).at("verdict"), "outside");
  }
}

}  // namespace
}  // namespace mosbench
