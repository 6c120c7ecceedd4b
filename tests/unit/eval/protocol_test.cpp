#include "eval/protocols/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/predictions.hpp"

namespace mosbench {
namespace {

TEST(Protocols, HoldEveryBenchmarkThatIsPromised) {
  for (const std::string_view name :
       {"doals-hmm", "doals-dynablox", "semantickitti-mos", "sipailou", "helimos-all",
        "helimos-test", "mapmos", "mapmos-apollo", "mapmos-kitti-tracking", "mapmos-nuscenes",
        "moe", "mdetector", "mdetector-kitti", "mdetector-nuscenes", "sceneflow-dynamic",
        "sceneflow-dynamic-far"}) {
    ASSERT_NE(find_protocol(name), nullptr) << name;
    EXPECT_EQ(find_protocol(name)->name, name);
  }
}

TEST(Protocols, AreCompleteRowsWithUniqueNames) {
  std::set<std::string_view> names;
  for (const Protocol& protocol : protocols()) {
    EXPECT_TRUE(names.insert(protocol.name).second) << protocol.name;
    EXPECT_FALSE(protocol.summary.empty()) << protocol.name;
    EXPECT_NE(protocol.source.find(':'), std::string_view::npos) << protocol.name;
    const LabelTable truth(protocol.truth);
    const LabelTable prediction(protocol.prediction);
    EXPECT_EQ(truth[9], TruthClass::kStatic) << protocol.name;
    EXPECT_EQ(prediction[9], TruthClass::kStatic) << protocol.name;
    EXPECT_EQ(prediction[251], TruthClass::kMoving) << protocol.name;
  }
}

TEST(Protocols, AreNotFoundByAnotherName) {
  EXPECT_EQ(find_protocol("helimos"), nullptr);
  EXPECT_EQ(find_protocol(""), nullptr);
}

TEST(Protocols, SuggestTheNearestNameForAnUnknownOne) {
  try {
    protocol_named("semantickiti-mos");
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "protocol: \"semantickiti-mos\" does not exist, expected a name that "
                 "`mosbench list` shows, such as \"semantickitti-mos\"");
  }
}

TEST(Protocols, AreDescribedInWords) {
  const auto rows = describe_protocols();
  ASSERT_EQ(rows.size(), protocols().size());
  EXPECT_EQ(rows[0].name, "doals-hmm");
  EXPECT_EQ(rows[0].truth, "0-250 static, 251-65535 moving");
  EXPECT_EQ(rows[0].prediction, "251-65535");
  EXPECT_EQ(rows[0].range, "truth only, 0.5 to 20 m by default");
  EXPECT_EQ(rows[0].aggregation, "mean of scans");
  EXPECT_EQ(rows[0].empty_case, "NaN");
  const auto& sipailou = rows[3];
  EXPECT_EQ(sipailou.name, "sipailou");
  EXPECT_EQ(sipailou.truth, "0 9 static, 251-252 moving, others static");
  EXPECT_EQ(sipailou.range, "none");
  EXPECT_EQ(sipailou.split, "test");
  EXPECT_EQ(rows[0].split, "all labelled scans");
  const auto& mapmos = rows[6];
  EXPECT_EQ(mapmos.name, "mapmos");
  EXPECT_EQ(mapmos.range, "truth and prediction, no limit by default");
  EXPECT_EQ(rows[9].name, "mapmos-nuscenes");
  EXPECT_EQ(rows[9].range, "truth and prediction, from 3 m by default");
  EXPECT_EQ(rows[14].name, "sceneflow-dynamic");
  EXPECT_EQ(rows[14].range, "truth and prediction, 0 to 35 m in x and y by default");
}

TEST(RangeGate, IncludesBothEnds) {
  const RangeGate gate{0.5, 20.0};
  EXPECT_TRUE(gate.contains(0.5));
  EXPECT_TRUE(gate.contains(20.0));
  EXPECT_FALSE(gate.contains(0.49999999));
  EXPECT_FALSE(gate.contains(20.0000001));
}

TEST(RangeGate, HasNoUpperLimitWhenItIsNegativeOrZero) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE((RangeGate{0.0, -1.0}.contains(1e9)));
  EXPECT_TRUE((RangeGate{0.0, 0.0}.contains(infinity)));
  EXPECT_FALSE((RangeGate{0.0, 20.0}.contains(infinity)));
}

TEST(RangeGate, NeverContainsARangeThatIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((RangeGate{0.0, -1.0}.contains(nan)));
  EXPECT_FALSE((RangeGate{0.5, 20.0}.contains(nan)));
}

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  const std::array<std::string_view, 3> names = {"sipailou", "helimos", "doals"};
  EXPECT_EQ(nearest_name("sipalou", names), "sipailou");
  EXPECT_EQ(nearest_name("heliMOS", names), "helimos");
  EXPECT_EQ(nearest_name("DOALS", names), "doals");
  EXPECT_EQ(nearest_name("doal", names), "doals");
}

TEST(NearestName, WeighsInsertedDeletedAndReplacedCharactersAlike) {
  const std::array<std::string_view, 2> insertion = {"xoxl", "doals"};
  EXPECT_EQ(nearest_name("doal", insertion), "doals");
  const std::array<std::string_view, 2> deletion = {"xoxlsx", "doals"};
  EXPECT_EQ(nearest_name("doalss", deletion), "doals");
  const std::array<std::string_view, 2> replacement = {"d", "doals"};
  EXPECT_EQ(nearest_name("doakx", replacement), "doals");
}

TEST(NearestName, IsEmptyWithoutCandidates) { EXPECT_EQ(nearest_name("doals", {}), ""); }

/// The sections of a Markdown file by their heading of third level.
std::map<std::string, std::string> sections_of(const std::string& markdown) {
  std::map<std::string, std::string> sections;
  std::string* section = nullptr;
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) {
      section = line.starts_with("### ") ? &sections[line.substr(4)] : nullptr;
    } else if (section != nullptr) {
      *section += line + '\n';
    }
  }
  return sections;
}

std::string source_file(const char* name) {
  return read_file(std::filesystem::path(MOSBENCH_SOURCE_DIR) / name);
}

TEST(Protocols, HaveASectionEachOnTheirPage) {
  const auto sections = sections_of(source_file("docs/protocols/protocols.md"));
  EXPECT_EQ(sections.size(), protocols().size());
  for (const ProtocolDescription& protocol : describe_protocols())
    EXPECT_TRUE(sections.contains(protocol.name)) << protocol.name;
}

TEST(PredictionFormats, AreAllDescribedInTheReadme) {
  const std::string readme = source_file("docs/formats/predictions.md");
  for (const DescribedFormat& format : prediction_formats()) {
    EXPECT_NE(readme.find("| `" + std::string(format.name) + "` |"), std::string::npos)
        << format.name;
  }
}

TEST(ProtocolList, SaysTheRangeThatIsAppliedAndNoOther) {
  const auto line = [](const char* name, const RangeGate& range) {
    return rule_line({&protocol_named(name), range});
  };
  EXPECT_EQ(line("mapmos-nuscenes", {0.0, 50.0}),
            "protocol mapmos-nuscenes: pooled; as mapmos, all scans with boxes (0 to 50 m)");
  EXPECT_THAT(line("mapmos-nuscenes", {3.0, -1.0}), testing::EndsWith("(from 3 m)"));
  EXPECT_EQ(rule_name({&protocol_named("sipailou"), {0.0, -1.0}}), "sipailou");
}

}  // namespace
}  // namespace mosbench
