#include <gtest/gtest.h>

#include <mosbench/method.hpp>

#include "datasets/layouts/dataset.hpp"
#include "tests/rig_drive.hpp"

/// Labels of a rig whose rays start at each point's own LiDAR.
namespace mosbench {
namespace {

/// IoU of what moves.
double iou_of(const Sequence& rig, const char* name, bool own_origins) {
  const MethodKind* kind = find_method(name);
  Settings settings = kind->defaults;
  settings.set("max_range_m", 20.0);
  const auto method = kind->make(settings, {});
  double both = 0, either = 0;
  for (std::size_t k = 0; k < rig.size(); ++k) {
    const Frame frame = rig.read(k);
    const auto found = method->push(frame.points, frame.map_from_sensor,
                                    own_origins ? frame.origins : RayOrigins{});
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const bool moves = (*frame.truth)[i] == 251, is_found = found.at(0).labels[i] == kMovingLabel;
      both += moves && is_found ? 1 : 0;
      either += moves || is_found ? 1 : 0;
    }
  }
  return both / either;
}

TEST(RigOfTwoLidars, IsLabelledBetterWithTheOriginsOfItsPoints) {
  const TempFolder folder;
  folder.write("drive.bag", RigDrive{.scans = 20}.bag());
  const Dataset data = open_dataset(folder / "drive.bag", {.reading = {.lidars = "/a,/b"}});
  const Sequence& rig = *data.sequences.front();
  const double one = iou_of(rig, "hmm-mos", false);
  EXPECT_GT(one, 0.5);
  EXPECT_GT(iou_of(rig, "hmm-mos", true), one + 0.01);
  // hmm-mos-plus hardly differs here: it asks for known space all around a seed.
  EXPECT_GT(iou_of(rig, "hmm-mos-plus", true), iou_of(rig, "hmm-mos-plus", false) - 0.002);
}

}  // namespace
}  // namespace mosbench
