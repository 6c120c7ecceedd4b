#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/rosbag/bag_file.hpp"
#include "datasets/rosbag/bag_writer.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Points, stamps, truth and, within `pose_error`, poses of two data sets are the same.
void expect_same_frames(const std::filesystem::path& a, const std::filesystem::path& b,
                        double pose_error) {
  const Dataset first = open_dataset(a, {});
  const Dataset second = open_dataset(b, {});
  ASSERT_EQ(first.sequences.size(), second.sequences.size());
  for (std::size_t s = 0; s < first.sequences.size(); ++s) {
    ASSERT_EQ(first.sequences[s]->size(), second.sequences[s]->size());
    for (std::size_t k = 0; k < first.sequences[s]->size(); ++k) {
      const Frame expected = first.sequences[s]->read(k);
      const Frame frame = second.sequences[s]->read(k);
      ASSERT_EQ(frame.points.size(), expected.points.size());
      EXPECT_EQ(std::memcmp(frame.points.data(), expected.points.data(),
                            expected.points.size() * sizeof(Point)),
                0);
      EXPECT_EQ(frame.truth, expected.truth);
      EXPECT_LE((frame.map_from_sensor.matrix() - expected.map_from_sensor.matrix())
                    .cwiseAbs()
                    .maxCoeff(),
                pose_error);
      if (expected.stamp_ns) {
        EXPECT_EQ(frame.stamp_ns, expected.stamp_ns);
      }
    }
  }
}

class Convert : public testing::Test {
 protected:
  std::string simulate(const std::string& layout, const char* scans = "12") const {
    const std::string out = (folder_ / layout).string();
    const cli::Answer answer = cli::run({"simulate", "--layout", layout, "--scene", "room",
                                         "--scans", scans, "--seed", "5", "--out", out});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return out;
  }
  cli::Answer convert(const std::string& input, const std::string& layout, const char* out,
                      const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"convert", input,   "--layout",
                                          layout,    "--out", (folder_ / out).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return cli::run(arguments);
  }
  nlohmann::json scores(const std::string& input, const char* out) const {
    const cli::Answer answer =
        cli::run({"run", input, "--out", (folder_ / out).string(), "--json"});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary");
  }

  TempFolder folder_;
};

TEST_F(Convert, MakesABagOfSeveralChunksThatReadsAndScoresAsTheExportedScans) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  const std::string exported = simulate("doals");
  const nlohmann::json expected = scores(exported, "out");
  ASSERT_GT(expected.dump().size(), 20U);
  for (const char* compression : {"none", "lz4", "bz2"}) {
    const std::string bags = std::string("bags_") + compression;
    const cli::Answer answer =
        convert(exported, "doals-bag", bags.c_str(), {"--compression", compression});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_THAT(answer.out, HasSubstr("converted 12 scans"));
    std::filesystem::path bag;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / bags)) {
      if (entry.path().extension() == ".bag") bag = entry.path();
    }
    ASSERT_FALSE(bag.empty());
    const auto messages = BagFile(bag).messages("/os1_cloud_node/points");
    ASSERT_EQ(messages.size(), 12U);
    EXPECT_GT(messages.back().chunk, 3U);
    expect_same_frames(exported, folder_ / bags, 1e-12);
    EXPECT_EQ(scores((folder_ / bags).string(), (bags + "_out").c_str()), expected);
  }
}

TEST_F(Convert, TurnsEveryLayoutIntoEveryOther) {
  for (const std::string from : {"doals", "sipailou", "helimos", "semantickitti"}) {
    const std::string input = simulate(from, "6");
    for (const std::string to : {"doals", "sipailou", "helimos", "semantickitti"}) {
      const std::string out = from + "_as_" + to;
      const cli::Answer answer = convert(input, to, out.c_str());
      ASSERT_EQ(answer.exit_code, 0) << out << answer.err;
      if (to == "doals") {
        EXPECT_EQ(open_dataset(folder_ / out, {}).kind, DatasetKind::kDoals);
      } else {
        expect_same_frames(input, folder_ / out, 1e-12);
      }
    }
  }
}

TEST_F(Convert, MakesABagOfScansWithoutStamps) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  cli::write_small_sequence(folder_ / "room", 3);
  const cli::Answer answer = convert((folder_ / "room").string(), "doals-bag", "bags");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  expect_same_frames(folder_ / "room", folder_ / "bags", 1e-12);
  EXPECT_EQ(open_dataset(folder_ / "bags", {}).sequences.at(0)->stamp_ns(2), 200'000'000);
}

TEST_F(Convert, RefusesAFilledFolderAndAnUnknownLayout) {
  const std::string input = simulate("doals", "6");
  folder_.write("out/keep", "mine");
  const cli::Answer filled = convert(input, "doals", "out");
  EXPECT_EQ(filled.exit_code, 2);
  EXPECT_THAT(filled.err, HasSubstr("holds files already"));
  EXPECT_EQ(convert(input, "kitti", "other").exit_code, 2);
}

TEST_F(Convert, StatesInTheResultHowASequenceWasRead) {
  cli::write_small_sequence(folder_ / "room", 6);
  folder_.write("p.csv",
                "0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n"
                "0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n");
  const std::vector<std::string> command = {"run", (folder_ / "room").string(), "--out",
                                            (folder_ / "out").string()};
  ASSERT_EQ(cli::run(command).exit_code, 0);
  auto told = command;
  told.insert(told.end(), {"--poses", (folder_ / "p.csv").string()});
  const cli::Answer other = cli::run(told);
  EXPECT_EQ(other.exit_code, 2) << "the same files read otherwise are another run";
  EXPECT_THAT(other.err, HasSubstr("reading"));
  told.emplace_back("--overwrite");
  ASSERT_EQ(cli::run(told).exit_code, 0);
  const auto reading = cli::timeless_result(folder_ / "out/room").at("reading");
  EXPECT_EQ(reading.at("pose_format"), "dynablox");
  EXPECT_EQ(reading.at("pose_direction"), "sensor_from_map, inverted");
}

}  // namespace
}  // namespace mosbench
