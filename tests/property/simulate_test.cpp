#include "datasets/simulator/simulate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

SimulateOptions options_for(DatasetKind layout, const std::filesystem::path& out,
                            std::size_t scans = 12) {
  return {.layout = layout, .scene = "room", .scans = scans, .seed = 5, .out = out, .threads = 2};
}

std::map<std::string, std::string> files_below(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(folder).string()] = read_file(entry.path());
  }
  return files;
}

OpenOptions as(DatasetKind kind) {
  OpenOptions options;
  options.kind = kind;
  return options;
}

double distance_between(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

std::uint32_t layout_label(DatasetKind layout, const SimulatedScan& scan, std::size_t point) {
  return layout_of(layout).simulation->label(scan.at(point));
}

class EveryLayout : public testing::TestWithParam<DatasetKind> {};

INSTANTIATE_TEST_SUITE_P(Simulate, EveryLayout,
                         testing::Values(DatasetKind::kDoals, DatasetKind::kSipailou,
                                         DatasetKind::kHelimos, DatasetKind::kSemanticKitti,
                                         DatasetKind::kNuscenes, DatasetKind::kHelipr,
                                         DatasetKind::kKittiRaw, DatasetKind::kKittiTracking),
                         [](const auto& layout) {
                           std::string name(to_string(layout.param));
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// Labels of the layout for the points that its files keep.
struct Expected {
  std::vector<Point> points;
  std::vector<std::uint32_t> labels;
};

Expected expected_scan(DatasetKind layout, const SimulatedScan& scan) {
  Expected expected;
  const bool keeps_all = layout == DatasetKind::kDoals;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const bool returned = scan.owners[i] != SimulatedScan::kNoReturn;
    if (!returned && !keeps_all) continue;
    expected.points.push_back(scan.points[i]);
    if (!keeps_all) expected.labels.push_back(layout_label(layout, scan, i));
  }
  return expected;
}

TEST_P(EveryLayout, OpensWithItsReaderAndHoldsThePointsLabelsAndMotionOfTheSimulator) {
  const TempFolder folder;
  constexpr std::size_t kScans = 12;
  simulate(options_for(GetParam(), folder / "sim", kScans));
  const Dataset dataset = open_dataset(folder / "sim", as(GetParam()));
  const Scene scene = built_in_scene("room");
  const auto recordings = recordings_of(GetParam(), scene);
  const auto labelled = labelled_scans(GetParam(), kScans);
  ASSERT_EQ(dataset.sequences.size(), recordings.size());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Sequence& sequence = *dataset.sequences[r];
    const Simulator simulator(scene, sensor_model(recordings[r].sensor), 5);
    ASSERT_EQ(sequence.size(), kScans);
    const Pose first = sequence.read(0).map_from_sensor;
    const Pose simulated_first = simulator.scan(0).map_from_sensor;
    for (std::size_t i = 0; i < kScans; ++i) {
      const SimulatedScan scan = simulator.scan(i);
      const Frame frame = sequence.read(i);
      const Expected expected = expected_scan(GetParam(), scan);
      ASSERT_EQ(frame.points.size(), expected.points.size());
      EXPECT_TRUE(std::equal(
          frame.points.begin(), frame.points.end(), expected.points.begin(),
          [](const Point& a, const Point& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }));
      EXPECT_EQ(sequence.has_truth(i), labelled.contains(i)) << "scan " << i;
      if (frame.truth && GetParam() != DatasetKind::kDoals) {
        EXPECT_EQ(*frame.truth, expected.labels);
      }
      EXPECT_LT(distance_between(first.inverse() * frame.map_from_sensor,
                                 simulated_first.inverse() * scan.map_from_sensor),
                1e-9)
          << sequence.name() << " scan " << i;
    }
  }
}

TEST_P(EveryLayout, IsRecognisedWithoutBeingTold) {
  const TempFolder folder;
  simulate(options_for(GetParam(), folder / "sim", 5));
  EXPECT_EQ(open_dataset(folder / "sim", {}).kind, GetParam());
}

TEST_P(EveryLayout, WritesTheSameFilesFromAnyNumberOfThreadsAndTwiceInARow) {
  const TempFolder folder;
  SimulateOptions options = options_for(GetParam(), folder / "two", 6);
  simulate(options);
  const auto once = files_below(folder / "two");
  ASSERT_GT(once.size(), 9U);
  simulate(options);
  EXPECT_EQ(files_below(folder / "two"), once);
  options.out = folder / "one";
  options.threads = 1;
  simulate(options);
  EXPECT_EQ(files_below(folder / "one"), once);
}

TEST_P(EveryLayout, CompletesWhatAKilledRunLeft) {
  const TempFolder folder;
  const SimulateOptions options = options_for(GetParam(), folder / "sim", 6);
  EXPECT_THROW(simulate(options,
                        [](std::size_t done, std::size_t) {
                          if (done == 3) throw std::runtime_error("killed");
                        }),
               std::runtime_error);
  EXPECT_THROW(open_dataset(folder / "sim", as(GetParam())), DataError);
  simulate(options);
  SimulateOptions undisturbed = options;
  undisturbed.out = folder / "undisturbed";
  simulate(undisturbed);
  EXPECT_EQ(files_below(folder / "sim"), files_below(folder / "undisturbed"));
}

TEST_P(EveryLayout, SaysThatItIsSimulated) {
  const TempFolder folder;
  simulate(options_for(GetParam(), folder / "sim", 5));
  const Dataset dataset = open_dataset(folder / "sim", as(GetParam()));
  for (const auto& sequence : dataset.sequences) {
    const auto origin = sequence->simulated();
    ASSERT_TRUE(origin) << sequence->name();
    EXPECT_EQ(origin->layout, to_string(GetParam()));
    EXPECT_EQ(origin->scene, "room");
    EXPECT_EQ(origin->scans, 5U);
    EXPECT_EQ(origin->seed, 5U);
  }
  EXPECT_FALSE(simulated_origin(folder.path()));
  EXPECT_THAT(read_file(folder / "sim/README.txt"), HasSubstr("simulated"));
  EXPECT_EQ(format_scene(read_scene(folder / "sim/scene.json")),
            format_scene(built_in_scene("room")));
}

TEST(Simulate, CountsScansOfAllSensors) {
  const TempFolder folder;
  std::vector<std::size_t> done;
  simulate(options_for(DatasetKind::kHelimos, folder / "sim", 3),
           [&](std::size_t now, std::size_t total) {
             done.push_back(now);
             EXPECT_EQ(total, 12U);
           });
  ASSERT_EQ(done.size(), 12U);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
}

TEST(Simulate, RefusesAFolderWithOtherContent) {
  const TempFolder folder;
  folder.write("photos/holiday.jpg", "x");
  EXPECT_THAT(message_of<UsageError>(
                  [&] { simulate(options_for(DatasetKind::kDoals, folder / "photos")); }),
              HasSubstr("holds files that are no simulation; choose another out"));
  EXPECT_EQ(files_below(folder / "photos").size(), 1U);

  SimulateOptions options = options_for(DatasetKind::kDoals, folder / "sim", 2);
  simulate(options);
  const auto before = files_below(folder / "sim");
  options.seed = 6;
  EXPECT_THAT(message_of<UsageError>([&] { simulate(options); }), HasSubstr("other parameters"));
  EXPECT_EQ(files_below(folder / "sim"), before);
}

TEST(Simulate, RefusesParametersThatMakeNoDataSet) {
  const TempFolder folder;
  EXPECT_THROW(simulate(options_for(DatasetKind::kDoals, folder / "sim", 0)), UsageError);
  EXPECT_THROW(simulate(options_for(DatasetKind::kDoals, "", 1)), UsageError);
  SimulateOptions options = options_for(DatasetKind::kHelimos, folder / "sim", 1);
  options.scene = "rom";
  EXPECT_THAT(message_of<UsageError>([&] { simulate(options); }), HasSubstr("'room'"));
  options.scene = folder / "missing.json";
  EXPECT_THROW(simulate(options), DataError);
  Scene scene = built_in_scene("room");
  scene.sensor = "vlp-16";
  options.scene = folder.write("vlp.json", format_scene(scene));
  EXPECT_THAT(message_of<UsageError>([&] { simulate(options); }), HasSubstr("four sensors"));
  EXPECT_FALSE(std::filesystem::exists(folder / "sim"));
}

TEST(SimulatedDoals, KeepsEverySlotWithMissingReturnsAsZeros) {
  const TempFolder folder;
  simulate(options_for(DatasetKind::kDoals, folder / "sim", 1));
  const Dataset dataset = open_dataset(folder / "sim", as(DatasetKind::kDoals));
  const Frame frame = dataset.sequences.front()->read(0);
  EXPECT_EQ(frame.points.size(), 131072U);
  const auto missing = std::count_if(frame.points.begin(), frame.points.end(), [](const Point& p) {
    return p.x == 0.0F && p.y == 0.0F && p.z == 0.0F;
  });
  // One per cent drops out at random, and a room leaves few rays without a wall.
  EXPECT_GT(missing, 1000);
  EXPECT_LT(missing, 3000);
}

TEST(SimulatedDoals, ListsAPersonWhoStandsStillAsDynamic) {
  Scene scene = built_in_scene("room");
  scene.movers = {
      {.kind = MoverKind::kPedestrian, .route = {.from_m = {0.0, 2.0}}, .labelled = true}};
  const Simulator simulator(scene, sensor_model(SensorKind::kOs1_64), 1);
  const SimulatedScan scan = simulator.scan(3);
  const auto owner_of_pedestrian = static_cast<std::uint32_t>(1 + scene.structures.size());
  std::size_t of_pedestrian = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] != owner_of_pedestrian) continue;
    ++of_pedestrian;
    EXPECT_EQ(layout_label(DatasetKind::kDoals, scan, i), kMovingLabel);
    EXPECT_EQ(moving_label(scan.at(i)), kStaticLabel);
  }
  EXPECT_GT(of_pedestrian, 300U);
}

TEST(SimulatedDoals, LabelsTenScansByStampOrFewerWhenShort) {
  EXPECT_EQ(labelled_scans(DatasetKind::kDoals, 100),
            (std::set<std::size_t>{9, 19, 29, 39, 49, 59, 69, 79, 89, 99}));
  EXPECT_EQ(labelled_scans(DatasetKind::kDoals, 12), (std::set<std::size_t>{5, 6, 7, 8, 9, 11}));
  EXPECT_EQ(labelled_scans(DatasetKind::kDoals, 2), (std::set<std::size_t>{1}));
}

TEST(SimulatedHelimos, LabelsPartOfTheScansAndSplitsThemInBlocks) {
  const auto labelled = labelled_scans(DatasetKind::kHelimos, 200);
  EXPECT_EQ(labelled.size(), 49U);
  SplitNumbers splits = simulated_splits(labelled);
  EXPECT_EQ(splits["test"].size(), 7U);
  EXPECT_EQ(splits["val"].size(), 7U);
  EXPECT_EQ(splits["train"].size(), 35U);
  EXPECT_LT(*splits["train"].rbegin(), *splits["val"].begin());
  EXPECT_LT(*splits["val"].rbegin(), *splits["test"].begin());
  EXPECT_EQ(simulated_splits({7}), (SplitNumbers{{"test", {7}}}));
}

TEST(SimulatedNuscenes, HasKeyFramesTwiceASecondAndTurnsNothingUnlabelled) {
  EXPECT_EQ(labelled_scans(DatasetKind::kNuscenes, 17), (std::set<std::size_t>{4, 9, 14}));
  EXPECT_EQ(labelled_scans(DatasetKind::kNuscenes, 3), (std::set<std::size_t>{2}));
  EXPECT_THAT(labelled_scans(DatasetKind::kHelipr, 17), testing::IsEmpty());
  Scene scene = built_in_scene("room");
  for (Mover& mover : scene.movers) mover.labelled = false;
  const SimulatedScan scan = Simulator(scene, sensor_model(SensorKind::kHdl32e), 1).scan(4);
  std::map<std::uint32_t, std::size_t> count;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const std::uint32_t label = layout_label(DatasetKind::kNuscenes, scan, i);
    EXPECT_EQ((label & 0xFFFFU) == kMovingLabel, scan.scene.owners[scan.owners[i]].moving);
    EXPECT_EQ(label >> 16U, label == kStaticLabel ? 0U : scan.owners[i]);
    ++count[label & 0xFFFFU];
  }
  EXPECT_EQ(count.size(), 2U) << "9 and 251";
}

TEST(SimulatedLayouts, AreThoseThatHaveRecordings) {
  EXPECT_EQ(
      simulated_layout_names(),
      "doals, sipailou, helimos, semantickitti, opensceneflow, nuscenes, helipr, kitti-raw or "
      "kitti-tracking");
  EXPECT_EQ(simulated_layout_from_string("helipr"), DatasetKind::kHelipr);
  EXPECT_EQ(simulated_layout_from_string("recording"), std::nullopt);
  EXPECT_EQ(simulated_layout_from_string("kitti"), std::nullopt);
}

TEST(SimulatedSipailou, LabelsOnlyFromThreeToFiftyMetres) {
  const Simulator simulator = built_in_simulator("street", "avia", 1);
  const SimulatedScan scan = simulator.scan(10);
  std::map<std::uint32_t, std::size_t> count;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const Point& p = scan.points[i];
    const double range_m = std::sqrt(double{p.x} * p.x + double{p.y} * p.y + double{p.z} * p.z);
    const std::uint32_t label = layout_label(DatasetKind::kSipailou, scan, i);
    EXPECT_EQ(label == 0, range_m < 3.0 || range_m > 50.0) << range_m;
    ++count[label];
  }
  EXPECT_GT(count[0], 100U);
  EXPECT_GT(count[9], 5000U);
  EXPECT_GT(count[251] + count[252], 100U);
  EXPECT_EQ(count.size(), 4U);
}

TEST(SimulatedSemanticKitti, NamesClassesAndInstances) {
  const Simulator simulator = built_in_simulator("street", "hdl-64e", 1);
  const SimulatedScan scan = simulator.scan(10);
  std::set<std::uint32_t> classes;
  bool has_instances = false;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const std::uint32_t label = layout_label(DatasetKind::kSemanticKitti, scan, i);
    EXPECT_EQ((label & 0xFFFF) > 250, moving_label(scan.at(i)) == kMovingLabel);
    classes.insert(label & 0xFFFF);
    has_instances = has_instances || label > 0xFFFF;
  }
  EXPECT_THAT(classes, testing::IsSupersetOf({40U, 50U, 70U, 80U, 10U, 252U, 254U}));
  EXPECT_TRUE(has_instances);
}

}  // namespace
}  // namespace mosbench
