#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/parity_cases.hpp"

// `mosbench run` on real HDL-64E scans with moving truth, against the labels and the counts of the
// authors' own program.
namespace mosbench {
namespace {

parity::ParityCase case_named(const std::string& name) {
  for (const parity::ParityCase& parity : parity::parity_cases()) {
    if (parity.name == name) return parity;
  }
  throw std::runtime_error(name + ": no such parity case");
}

parity::Counts counts_of(const nlohmann::ordered_json& json) {
  return {json.at("tp").get<std::uint64_t>(), json.at("fp").get<std::uint64_t>(),
          json.at("fn").get<std::uint64_t>()};
}

class RunParity : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!parity::parity_root()) GTEST_SKIP() << parity::kSkipMessage;
  }
};

TEST_P(RunParity, LabelsAndCountsEqualTheAuthorsProgram) {
  const parity::ParityCase parity = case_named(GetParam());
  const TempFolder folder;
  const auto original = nlohmann::ordered_json::parse(
      read_file(*parity::shared_parity_folder() / "cases" / parity.name / "case.json"));
  const auto config = folder.write("config.json", original.at("config").dump());
  struct Rule {
    const char* protocol;
    const char* counts;
  };
  for (const Rule& rule : {Rule{"semantickitti-mos", "truth_unlabelled_ignored"},
                           Rule{"sipailou", "truth_unlabelled_static"}}) {
    const auto out = folder / rule.protocol;
    const cli::Answer answer =
        cli::run({"run", parity::sequence_folder(parity).string(), "--config", config.string(),
                  "--variant", original.at("variant").get<std::string>(), "--protocol",
                  rule.protocol, "--out", out.string()});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    for (std::size_t k = 0; k < parity.scans; ++k) {
      const auto file = out / parity.sequence / "labels" / (parity::stem(k) + ".label");
      EXPECT_EQ(parity::read_records<std::uint32_t>(file), parity::expected_of(parity, k))
          << "scan " << k;
    }
    const auto result = cli::timeless_result(out / parity.sequence);
    for (const auto& [key, value] : original.at("config").items()) {
      EXPECT_EQ(result.at("settings").at(key), value) << key;
    }
    EXPECT_EQ(result.at("settings").at("variant"), original.at("variant"));
    EXPECT_EQ(counts_of(result.at("summary")), counts_of(original.at(rule.counts)));
    EXPECT_DOUBLE_EQ(result.at("summary").at("iou"), original.at(rule.counts).at("iou"));
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, RunParity,
                         testing::Values("kitti_r50", "kitti_r50_delay10", "kitti_r50_release2025"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace mosbench
