#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "tests/cli/program.hpp"
#include "tests/hdf5_bytes.hpp"

namespace mosbench {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

/// Points, poses, stamps and truth of two sequences are the same.
void expect_same_scans(const std::filesystem::path& a, const std::filesystem::path& b) {
  const Dataset first = open_dataset(a, {}), second = open_dataset(b, {});
  const Sequence& expected = *first.sequences.at(0);
  const Sequence& found = *second.sequences.at(0);
  ASSERT_EQ(found.size(), expected.size());
  std::size_t labelled = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const Frame frame = expected.read(k), again = found.read(k);
    ASSERT_EQ(again.points.size(), frame.points.size());
    EXPECT_EQ(
        std::memcmp(again.points.data(), frame.points.data(), frame.points.size() * sizeof(Point)),
        0);
    EXPECT_EQ(again.truth, frame.truth) << k;
    EXPECT_EQ(again.stamp_ns, frame.stamp_ns);
    EXPECT_LE(
        (again.map_from_sensor.matrix() - frame.map_from_sensor.matrix()).cwiseAbs().maxCoeff(),
        1e-12);
    if (frame.truth) ++labelled;
  }
  EXPECT_GT(labelled, 0U);
}

class SceneFlowProgram : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "this build is without libhdf5";
    const cli::Answer made = cli::run({"simulate", "--layout", "opensceneflow", "--scene", "street",
                                       "--scans", "12", "--seed", "5", "--out", path("sim")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }

  TempFolder folder_;
};

TEST_F(SceneFlowProgram, LabelsScoresAndChecksWhatItSimulates) {
  const Dataset data = open_dataset(path("sim"), {});
  EXPECT_EQ(data.kind, DatasetKind::kOpenSceneFlow);
  EXPECT_EQ(data.sequences.at(0)->name(), "street");
  std::map<std::uint32_t, std::size_t> points_of_id;
  for (const std::uint32_t label : data.sequences[0]->read_truth(4))
    ++points_of_id[label & 0xFFFFU];
  for (const std::uint32_t id : {9U, 40U, 251U}) EXPECT_GT(points_of_id[id], 50U) << id;

  const cli::Answer ran = cli::run({"run", path("sim"), "--out", path("out"), "--json"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const auto run = nlohmann::json::parse(ran.out);
  EXPECT_EQ(run.at("protocol"), "sceneflow-dynamic");
  const auto& summary = run.at("sequences").at(0).at("summary");
  EXPECT_EQ(summary.at("labelled_scans"), 11);
  EXPECT_GT(summary.at("tp"), 0);
  EXPECT_GT(summary.at("ignored"), 0);
  // Without eval_mask every point off the ground counts within the box of 70 x 70 m, whatever the
  // range of the method.
  std::size_t counted = 0, outside = 0;
  for (std::size_t k = 0; k < 11; ++k) {
    const Frame frame = data.sequences[0]->read(k);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const std::uint32_t id = frame.truth->at(i) & 0xFFFFU;
      if (id != 9 && id != 251) continue;
      const bool far = std::max(std::abs(frame.points[i].x), std::abs(frame.points[i].y)) > 35;
      ++(far ? outside : counted);
    }
  }
  std::size_t scored = 0;
  for (const char* count : {"tp", "fp", "fn", "tn"}) scored += summary.at(count).get<std::size_t>();
  EXPECT_EQ(scored, counted);
  EXPECT_GT(outside, 0U);
  const auto result = cli::timeless_result(folder_ / "out/street");
  EXPECT_EQ(result.at("reading").at("truth"), "flow, moving from 0.05 m to the next scan on");

  const cli::Answer doctor = cli::run({"doctor", path("sim/street.h5")});
  EXPECT_EQ(doctor.exit_code, 0) << doctor.out << doctor.err;
}

TEST_F(SceneFlowProgram, ConvertsToOtherLayoutsAndBack) {
  const auto convert = [&](const char* from, const char* layout, const char* to) {
    const cli::Answer answer =
        cli::run({"convert", path(from), "--layout", layout, "--out", path(to)});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  };
  convert("sim", "opensceneflow", "again");
  expect_same_scans(folder_ / "sim", folder_ / "again/street.h5");
  // The flow is kept, not only what it says of moving.
  const auto slow = open_dataset(path("again"), {.reading = {.moving_speed_m_s = 2.5}});
  const auto expected = open_dataset(path("sim"), {.reading = {.moving_speed_m_s = 2.5}});
  EXPECT_EQ(slow.sequences.at(0)->read_truth(4), expected.sequences.at(0)->read_truth(4));
  EXPECT_NE(slow.sequences.at(0)->read_truth(4),
            open_dataset(path("sim"), {}).sequences.at(0)->read_truth(4));
  convert("sim", "semantickitti", "kitti");
  expect_same_scans(folder_ / "sim", folder_ / "kitti");
  convert("kitti", "opensceneflow", "back");
  expect_same_scans(folder_ / "sim", folder_ / "back");
}

TEST_F(SceneFlowProgram, LeavesNothingWhereThereIsNoRoom) {
  // The first number, in the middle, and what libhdf5 writes when it closes the file.
  const auto whole = std::filesystem::file_size(path("sim/street.h5"));
  for (const rlim_t bytes : {rlim_t{2'000}, rlim_t{whole / 2}, rlim_t{whole - 1}}) {
    const cli::Answer answer = cli::run(
        {"convert", path("sim"), "--layout", "opensceneflow", "--out", path("new")}, [bytes] {
          const struct rlimit small { bytes, bytes };
          setrlimit(RLIMIT_FSIZE, &small);
        });
    EXPECT_EQ(answer.exit_code, 3) << bytes;
    EXPECT_THAT(answer.err, ContainsRegex("street.h5: cannot be written .*File too large"));
    EXPECT_FALSE(std::filesystem::exists(path("new"))) << bytes;
  }
}

TEST_F(SceneFlowProgram, ScoresDufoOfItsFiles) {
  const Dataset data = open_dataset(path("sim"), {});
  const Sequence& street = *data.sequences.at(0);
  std::vector<Hdf5GroupBytes> groups;
  for (std::size_t k = 0; k < street.size(); ++k) {
    std::vector<std::uint8_t> moves(street.point_count(k), 0);
    if (street.has_truth(k)) {
      const auto truth = street.read_truth(k);
      for (std::size_t i = 0; i < truth.size(); ++i) moves[i] = (truth[i] & 0xFFFFU) == 251U;
    }
    groups.push_back(
        {street.stem(k), {hdf5_array("dufo", Hdf5Number::Kind::kUnsigned, {moves.size()}, moves)}});
  }
  std::filesystem::create_directories(folder_ / "predicted");
  write_hdf5(folder_ / "predicted/street.h5", groups);
  const auto score = [&](const char* predictions) {
    return cli::run({"score", path("sim"), "--predictions", path(predictions), "--json"});
  };
  const cli::Answer answer = score("predicted");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_EQ(json.at("sequences").at(0).at("summary").at("iou"), 1.0);

  const cli::Answer none = score("sim");
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("street.h5: has no row for scans"));
  groups[3].arrays.front().second[7] = 2;
  write_hdf5(folder_ / "predicted/street.h5", groups);
  const cli::Answer wrong = score("predicted");
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("dufo of group " + street.stem(3) +
                                   " holds 2, expected 0 (static) or 1 (moving)"));
}

TEST_F(SceneFlowProgram, NamesAFileThatIsDamaged) {
  std::filesystem::resize_file(folder_ / "sim/street.h5", 100'000);
  const cli::Answer answer = cli::run({"run", path("sim"), "--out", path("out")});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err,
              HasSubstr("street.h5: cannot be read (libhdf5 cannot open it), expected"));
  EXPECT_EQ(cli::run({"run", path("sim"), "--moving-speed-m-s", "-1"}).exit_code, 2);
}

TEST_F(SceneFlowProgram, ConvertsByNoSpeedThatItsFilesCannotKeep) {
  const std::vector<std::string> words = {"convert", path("sim"), "--moving-speed-m-s", "2",
                                          "--layout"};
  const auto convert_to = [&](const std::string& layout, const std::string& source) {
    std::vector<std::string> all = words;
    all[1] = source;
    all.insert(all.end(), {layout, "--out", path(layout.c_str())});
    return cli::run(all);
  };
  const cli::Answer kept = convert_to("opensceneflow", path("sim"));
  EXPECT_EQ(kept.exit_code, 2);
  EXPECT_THAT(kept.err, HasSubstr("keeps the flow"));
  ASSERT_EQ(convert_to("semantickitti", path("sim")).exit_code, 0);
  // Labels without speeds become an array of labels, whose truth no speed changes.
  ASSERT_EQ(cli::run({"convert", path("semantickitti"), "--layout", "opensceneflow", "--out",
                      path("labels")})
                .exit_code,
            0);
  const cli::Answer labels =
      cli::run({"run", path("labels"), "--moving-speed-m-s", "2", "--out", path("run_labels")});
  EXPECT_EQ(labels.exit_code, 2);
  EXPECT_THAT(labels.err, HasSubstr("is its array mos_label"));
}

}  // namespace
}  // namespace mosbench
