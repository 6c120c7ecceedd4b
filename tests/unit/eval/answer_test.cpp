#include "eval/answer/answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Sheet wide_sheet() {
  return {.columns = {{"run", Unit::kText},
                      {"IoU", Unit::kNumber, 1},
                      {"recall", Unit::kNumber, 1},
                      {"ms"}},
          .rows = {{"mine", 61.2, 70.0, std::uint64_t{9}}}};
}

constexpr const char* kWide =
    "run    IoU  recall  ms\n"
    "----  ----  ------  --\n"
    "mine  61.2    70.0   9\n";

/// One of each kind of cell.
Answer answer_of_all() {
  return {.standing = Standing{true, "scene room, seed 5", {"INCOMPLETE: 1 scan is missing"}},
          .sheets = {{.title = "all",
                      .lead = {"above"},
                      .columns = {{"sequence", Unit::kText},
                                  {"scans"},
                                  {"IoU", Unit::kPercent},
                                  {"change", Unit::kPoints},
                                  {"ms/scan", Unit::kNumber, 1}},
                      .rows = {{"00", std::uint64_t{12}, Spread{0.6229, 0.5, 0.75}, -0.021, Cell()},
                               {},
                               {"01", std::uint64_t{3}, Spread{0.5, {}, {}, "too few"},
                                or_undefined(std::nullopt), 12.25}},
                      .notes = {"below"}}}};
}

TEST(Answer, IsShownToPeopleWithItsStandingAndALineAcross) {
  EXPECT_EQ(render(answer_of_all(), Format::kText),
            "all\nabove\n"
            "SIMULATED data (scene room, seed 5): not comparable with published numbers\n"
            "INCOMPLETE: 1 scan is missing\n\n"
            "sequence  scans  IoU %          95 %     change  ms/scan\n"
            "--------  -----  -----  ------------  ---------  -------\n"
            "00           12   62.3  [50.0, 75.0]      -2.10        -\n"
            "--------  -----  -----  ------------  ---------  -------\n"
            "01            3   50.0          none  undefined     12.2\n\n"
            "below\n");
}

TEST(Answer, AlignsColumnsAndEndsLinesAtTheirLastCell) {
  EXPECT_EQ(text_of({.columns = {{"name", Unit::kText}, {"IoU"}},
                     .rows = {{"a", "0.5"}, {}, {"longer"}}}),
            "name    IoU\n"
            "------  ---\n"
            "a       0.5\n"
            "------  ---\n"
            "longer\n");
}

TEST(Answer, HasUnitsAndEndsOfIntervalsInItsCsv) {
  EXPECT_EQ(render(answer_of_all(), Format::kCsv),
            "sequence,scans,iou_percent,iou_low_percent,iou_high_percent,change_points,ms_scan,"
            "standing\n"
            "00,12,62.29,50,75,-2.1,,\"SIMULATED data (scene room, seed 5): not comparable with "
            "published numbers; INCOMPLETE: 1 scan is missing\"\n"
            "01,3,50,,,,12.25,\"SIMULATED data (scene room, seed 5): not comparable with "
            "published numbers; INCOMPLETE: 1 scan is missing\"\n");
}

TEST(Answer, KeepsFractionsInItsJson) {
  const auto json = nlohmann::json::parse(render(answer_of_all(), Format::kJson));
  EXPECT_EQ(json.at("standing").size(), 2U);
  const auto& rows = json.at("sheets").at(0).at("rows");
  ASSERT_EQ(rows.size(), 2U) << "a line across is no row";
  EXPECT_EQ(rows.at(0).at("iou"),
            (nlohmann::json{{"value", 0.6229}, {"low", 0.5}, {"high", 0.75}, {"no_interval", {}}}));
  EXPECT_EQ(rows.at(1).at("iou").at("no_interval"), "too few");
  EXPECT_EQ(rows.at(1).at("change"), nullptr);
  EXPECT_EQ(rows.at(0).at("ms_scan"), nullptr);
}

TEST(Answer, LeadsByADaggerFromItsLatexToWhatItIsNot) {
  const std::string latex = render(answer_of_all(), Format::kLatex);
  EXPECT_THAT(latex, AllOf(HasSubstr("\\begin{tabular}{lrrrrr}\n"), HasSubstr("ms/scan$^\\dagger$"),
                           HasSubstr("\\multicolumn{6}{l}{$^\\dagger$ SIMULATED data"),
                           HasSubstr("% above\n"), HasSubstr("% below\n")));
}

TEST(Answer, LeadsFromEachRowOfItsLatexToEachOfItsDoubts) {
  Answer answer{.standing = Standing{}, .sheets = {{.columns = {{"x"}}}}};
  Sheet& sheet = answer.sheets[0];
  for (std::size_t row = 0; row < 28; ++row) {
    sheet.rows.push_back({std::uint64_t{1}});
    sheet.row_standing.push_back({.doubts = {"odd" + std::string(row + 1, '!')}});
  }
  sheet.row_standing[27].doubts.push_back("odd!");
  const std::string latex = render(answer, Format::kLatex);
  EXPECT_THAT(latex, HasSubstr("\n1$^{z}$ \\\\\n1$^{aa}$ \\\\\n1$^{a,ab}$ \\\\\n"));
  EXPECT_THAT(latex, HasSubstr("{$^{ab}$ odd" + std::string(28, '!') + "}"));
}

TEST(Answer, SaysInMarkdownAndHtmlWhatItIsNot) {
  EXPECT_THAT(render(answer_of_all(), Format::kMarkdown),
              AllOf(HasSubstr("### all\n\nabove\n\n**SIMULATED data"), HasSubstr("\n|---|--:|"),
                    Not(HasSubstr("----")), HasSubstr("\n- below\n")));
  EXPECT_THAT(render(answer_of_all(), Format::kHtml),
              AllOf(HasSubstr("<strong>SIMULATED data"), HasSubstr("<td class=\"l\">00</td>")));
}

TEST(Answer, OfNothingIsNothing) {
  for (const Format format : {Format::kText, Format::kJson, Format::kCsv, Format::kHtml}) {
    EXPECT_EQ(render({}, format), "");
  }
}

TEST(Answer, OfLinesIsFormattedToo) {
  const Answer answer{"wrote a<b\n"};
  EXPECT_EQ(render(answer, Format::kText), "wrote a<b\n");
  EXPECT_EQ(render(answer, Format::kCsv), "text\nwrote a<b\n");
  EXPECT_EQ(nlohmann::json::parse(render(answer, Format::kJson)).at("text"), "wrote a<b\n");
  EXPECT_EQ(render(answer, Format::kLatex), "\\begin{verbatim}\nwrote a<b\n\\end{verbatim}\n");
  EXPECT_EQ(render(answer, Format::kMarkdown), "```\nwrote a<b\n```\n");
  EXPECT_THAT(render(answer, Format::kHtml), HasSubstr("<pre>\nwrote a&lt;b\n</pre>"));
}

TEST(Answer, EscapesWhatStrangersWrote) {
  const Answer answer{.sheets = {{.title = "a_b<i>",
                                  .columns = {{"x|y&z", Unit::kText}},
                                  .rows = {{"=1+1\n\x1b[2J|\\<script>_"}}}}};
  EXPECT_THAT(render(answer, Format::kText), HasSubstr("=1+1\\x0a\\x1b[2J|\\<script>_"));
  EXPECT_THAT(render(answer, Format::kCsv), HasSubstr("\"'=1+1"));
  EXPECT_THAT(render(answer, Format::kLatex), AllOf(HasSubstr("a\\_b<i>"), HasSubstr("x|y\\&z"),
                                                    HasSubstr("|\\textbackslash{}<script>\\_")));
  EXPECT_THAT(
      render(answer, Format::kMarkdown),
      AllOf(HasSubstr("a_b\\<i\\>"), HasSubstr("x\\|y&z"), HasSubstr("\\|\\\\\\<script\\>_")));
  EXPECT_THAT(
      render(answer, Format::kHtml),
      AllOf(HasSubstr("a_b&lt;i&gt;"), HasSubstr("&lt;script&gt;_"), Not(HasSubstr("<script>"))));
}

TEST(Answer, HasRecordsOnlyInItsCsv) {
  Answer answer = answer_of_all();
  answer.standing = std::nullopt;
  answer.records = Sheet{.columns = {{"scan", Unit::kText}}, .rows = {{"a"}, {"b"}}};
  EXPECT_EQ(render(answer, Format::kCsv), "scan\na\nb\n");
  EXPECT_THAT(render(answer, Format::kText), Not(HasSubstr("\na\n")));
}

TEST(Answer, TellsGithubWhatFailed) {
  Answer answer{"regression\n", 1};
  answer.checks = {{"a,b", "IoU of a,b: dropped", "50 % before\nnow"}, {"c", "", ""}};
  EXPECT_EQ(render(answer, Format::kGithub),
            "regression\n::error title=IoU of a%2Cb%3A dropped::50 %25 before%0Anow\n");
  EXPECT_EQ(render(answer, Format::kText), "regression\n");
}

TEST(Answer, TellsCiServersWhatWasChecked) {
  Answer answer = answer_of_all();
  EXPECT_THROW(render(answer, Format::kJunit), UsageError) << "nothing was checked";
  answer.checks = {{"a<b>&\"c\"\x1b\xff\xef\xbf\xbf", "IoU", "was > is"}, {"d", "", ""}};
  EXPECT_THAT(
      render(answer, Format::kJunit),
      AllOf(testing::StartsWith("<?xml version=\"1.0\""), HasSubstr("tests=\"2\" failures=\"1\""),
            HasSubstr("name=\"a&lt;b&gt;&amp;&quot;c&quot;\\x1b\\xff\\uffff\"><failure "
                      "message=\"IoU: was &gt; is [SIMULATED data (scene room, seed 5): not "
                      "comparable with published numbers; INCOMPLETE: 1 scan is missing]\">"),
            HasSubstr("<testcase classname=\"mosbench\" name=\"d\"/>\n"),
            HasSubstr("<system-out>\n")));
}

TEST(Answer, WithoutAChartIsNoPicture) {
  EXPECT_THROW(render(answer_of_all(), Format::kPng), UsageError);
  Answer answer = answer_of_all();
  answer.charts = {{.title = "c", .x_label = "x", .y_label = "y", .curves = {{"a", {}, {{0, 1}}}}}};
  EXPECT_THAT(render(answer, Format::kPng), testing::StartsWith("\x89PNG"));
}

TEST(Formats, AreKnownByTheirNames) {
  for (const std::string_view name : format_names()) {
    EXPECT_EQ(format_names()[static_cast<std::size_t>(format_named(name))], name);
  }
  EXPECT_THROW(format_named("xml"), UsageError);
}

TEST(TextOfASheet, FoldsIntoATerminalBesideItsFirstColumn) {
  EXPECT_EQ(text_of(wide_sheet(), 19),
            "run    IoU  recall\n"
            "----  ----  ------\n"
            "mine  61.2    70.0\n"
            "\n"
            "run   ms\n"
            "----  --\n"
            "mine   9\n");
  EXPECT_EQ(text_of(wide_sheet(), 22), kWide) << "it fits";
  EXPECT_EQ(text_of(wide_sheet()), kWide);
}

TEST(TextOfASheet, ShowsAColumnThatIsWiderThanTheTerminalAllTheSame) {
  EXPECT_EQ(text_of(wide_sheet(), 3),
            "run    IoU\n----  ----\nmine  61.2\n\n"
            "run   recall\n----  ------\nmine    70.0\n\n"
            "run   ms\n----  --\nmine   9\n");
}

TEST(TextOfASheet, BreaksWordsBesideTheFirstColumn) {
  const Sheet sheet{.columns = {{"name", Unit::kText}, {"why", Unit::kText}},
                    .rows = {{"a", "one two three four five six"}}};
  EXPECT_EQ(text_of(sheet, 26),
            "name  why\n----  --------------------\na     one two three four\n      five six\n");
  EXPECT_EQ(text_of(sheet, 25), text_of(sheet)) << "there is hardly room for words";
}

}  // namespace
}  // namespace mosbench
