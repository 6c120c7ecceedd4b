#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/answer/render.hpp"
#include "eval/tables/table_print.hpp"
#include "tests/unit/eval/table_runs.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(TableBlocks, ComparesNothingThatIsOfAnotherKind) {
  const auto reasons = [](const ResultSet& run) {
    const FilledTable table = filled({run});
    const std::vector<TableRow> apart = rows_of_runs(table, true);
    EXPECT_EQ(apart.size(), 1U);
    EXPECT_THAT(rows_of_runs(table, false), IsEmpty()) << "no cell compares";
    const TableCell cell = apart.at(0).cells.at(0);
    EXPECT_EQ(cell.verdict, Verdict::kNotComparable);
    EXPECT_TRUE(cell.measured);
    EXPECT_FALSE(cell.published || cell.difference);
    return cell.reasons;
  };
  ResultSet simulated = station(889);
  for (Result& part : simulated.sequences) part.from.simulated.emplace();
  EXPECT_THAT(reasons(simulated), ElementsAre("simulated data"));

  ResultSet lost = station(889);
  lost.sequences[0].scans.pop_back();
  lost.sequences[0].predictions.emplace().missing = {"9"};
  EXPECT_THAT(reasons(lost),
              ElementsAre("INCOMPLETE: 1 scan without usable prediction is not counted",
                          "19 labelled scans, published over 20"));

  ResultSet short_ones = station(889);
  short_ones.sequences[0].scans.pop_back();
  EXPECT_THAT(reasons(short_ones), ElementsAre("19 labelled scans, published over 20"));

  ResultSet other = station(889);
  for (Result& part : other.sequences) part.protocol = &protocol_named("doals-dynablox");
  EXPECT_THAT(reasons(other), ElementsAre("protocol doals-dynablox, published doals-hmm"));
}

TEST(TableBlocks, HasNoAverageWhereASequenceIsMissing) {
  ResultSet half = station(889);
  half.sequences.pop_back();
  const FilledTable table = filled({half});
  const TableCell cell = cell_of(table);
  EXPECT_FALSE(cell.measured);
  EXPECT_EQ(cell.verdict, Verdict::kPublishedOnly);
  EXPECT_EQ(cell.published.value().iou_percent, "88.9");
  EXPECT_THAT(cell.sequences, ElementsAre("station/sequence_1"));
  EXPECT_THAT(cell.reasons,
              ElementsAre("no value over station/sequence_1, station/sequence_2: sequence "
                          "station/sequence_2 is missing",
                          HasSubstr("needs station/sequence_1, station/sequence_2")));
  EXPECT_THAT(rows_of_runs(table, true), IsEmpty());
  EXPECT_THAT(render(table_answer(table), Format::kText), testing::Not(HasSubstr("ST is station")));
}

/// One place is as published, the scans of the other are not: only the first stands beside it.
TEST(TableBlocks, DividesARunOfWhichOnePartCompares) {
  ResultSet run = station(889);
  for (const char* name : {"shopville/sequence_1", "shopville/sequence_2"}) {
    run.sequences.push_back(sequence(name, 9, 889, 200));
  }
  const FilledTable table = filled({run});
  const std::vector<TableRow> beside = rows_of_runs(table, false),
                              apart = rows_of_runs(table, true);
  ASSERT_EQ(beside.size(), 1U);
  ASSERT_EQ(apart.size(), 1U);
  EXPECT_EQ(beside[0].cells[0].verdict, Verdict::kWithin);
  EXPECT_TRUE(beside[0].cells[1].published);
  EXPECT_FALSE(beside[0].cells[1].measured);
  EXPECT_FALSE(apart[0].cells[0].measured || apart[0].cells[0].published);
  EXPECT_THAT(apart[0].cells[1].reasons, ElementsAre("18 labelled scans, published over 20"));
  EXPECT_EQ(table.rows.back().is_apart, true) << "those apart come last";
}

/// The paper's method was published over all labelled scans, others over those of the test split.
TEST(TableBlocks, PutsNoTestSplitBesideValuesOverAllScans) {
  const FilledTable table = filled({helimos("helimos-test", {"Avia", "Aeva"})}, "III");
  EXPECT_THAT(rows_of_runs(table, false), IsEmpty());
  const TableRow row = rows_of_runs(table, true).at(0);
  EXPECT_THAT(row.cells[0].reasons, Contains("protocol helimos-test, published helimos-all"));
  EXPECT_FALSE(row.cells[4].measured) << "an average over sensors that are missing";
  EXPECT_THAT(row.cells[4].reasons, Contains("no value over Avia, Aeva, Ouster, Velodyne: "
                                             "sequence Ouster, Velodyne is missing"));

  ResultSet other = helimos("helimos-test", {"Avia"});
  other.sequences[0].method = "Mine";
  const TableRow mine = rows_of_runs(filled({other}, "III"), false).at(0);
  EXPECT_EQ(mine.section, "test split");
  EXPECT_EQ(mine.cells[0].verdict, Verdict::kMeasuredOnly);
  other.sequences[0].protocol = &protocol_named("moe");
  EXPECT_THAT(rows_of_runs(filled({other}, "III"), true).at(0).cells[0].reasons,
              ElementsAre("protocol moe, by which nothing was published"));
}

TEST(TableBlocks, HasABlockPerSectionAndOneOfWhatDoesNotCompare) {
  const FilledTable table = filled({helimos("helimos-test", {"Avia"})}, "III");
  const Answer answer = table_answer(table);
  std::vector<std::string> titles;
  for (const Sheet& sheet : answer.sheets) titles.push_back(sheet.title);
  const std::string name = "Table III: HeLiMOS, moving IoU in % (paper, Table III)";
  EXPECT_THAT(titles, ElementsAre(name + ", test split", name + ", all labelled scans", name,
                                  name + ", not comparable with published values"));
  EXPECT_THAT(answer.sheets.front().lead.front(), HasSubstr("Avg: Avia, Aeva, Ouster, Velodyne."));
  for (const Format format : {Format::kText, Format::kMarkdown, Format::kLatex, Format::kHtml}) {
    EXPECT_THAT(render(answer, format),
                HasSubstr("(1) not comparable: protocol helimos-test, published helimos-all"));
  }
  EXPECT_THAT(render(answer, Format::kCsv),
              HasSubstr("helimos-test,L,,50,,,,not comparable,\"protocol helimos-test"));
  EXPECT_TRUE(to_json(table).at("rows").back().at("apart").get<bool>());
}

}  // namespace
}  // namespace mosbench
