// The doctor on .h5, nuScenes, HeLiPR and ROS 2 bags, written from scans of the simulator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/doctor/doctor.hpp"
#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/layouts/convert.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/simulator/simulate.hpp"
#include "tests/sanitizers.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

constexpr std::size_t kScans = 16;

/// Turns what a scan is given into what another is given, as a fault would.
using ScanFault = std::function<void(const Sequence& good, std::size_t scan_index, Frame& frame)>;

class Faulty : public SequenceAround {
 public:
  Faulty(std::unique_ptr<Sequence> good, ScanFault fault)
      : SequenceAround(std::move(good)), fault_(std::move(fault)) {}

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner().read(scan_index, frame);
    if (fault_) fault_(inner(), scan_index, frame);
  }

 private:
  ScanFault fault_;
};

void with_pose_of_the_scan_before(const Sequence& good, std::size_t scan_index, Frame& frame) {
  frame.map_from_sensor = good.map_from_sensor(scan_index == 0 ? 0 : scan_index - 1);
}

/// Point by point: files of flow hold as many rows as the scan has points.
void with_flow_of_the_scan_before(const Sequence& good, std::size_t scan_index, Frame& frame) {
  const Frame before = good.read(scan_index == 0 ? 0 : scan_index - 1);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const std::size_t other = std::min(i, before.points.size() - 1);
    frame.motions->velocities_m_s[i] = before.motions->velocities_m_s[other];
    (*frame.truth)[i] = (*before.truth)[other];
  }
}

/// What is written, of recordings as a bag.
struct Format {
  DatasetKind layout;
  BagKind bag = BagKind::kNone;
};

/// Writes the first recording of a layout, as a bag one of SemanticKITTI, and returns what the
/// doctor says of it.
Checkup checkup_with(const Format& format, const TempFolder& folder, ScanFault fault) {
  const bool is_bag = format.bag != BagKind::kNone;
  const DatasetKind layout = is_bag ? DatasetKind::kSemanticKitti : format.layout;
  Scene scene = load_scene("street");
  if (layout == DatasetKind::kOpenSceneFlow) scene.columns = 900;
  const SimulatedRecording recording = recordings_of(layout, scene).front();
  SimulateOptions simulation;
  simulation.layout = layout;
  simulation.scans = kScans;
  Dataset dataset;
  dataset.kind = layout;
  dataset.root = folder / "none";
  dataset.sequences.push_back(
      std::make_unique<Faulty>(simulated_sequence(simulation, scene, recording), std::move(fault)));
  ConvertOptions options;
  options.layout = format.layout;
  options.writing.bag = format.bag;
  options.writing.compression = "none";
  options.out = folder / "data";
  convert(dataset, options);
  return check_up(folder / "data", {});
}

class DoctorOnFormats : public testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    if (GetParam().layout == DatasetKind::kOpenSceneFlow && !has_hdf5()) {
      GTEST_SKIP() << "this build is without libhdf5";
    }
    if (kSanitized) GTEST_SKIP() << "takes minutes in sanitized builds";
  }

  TempFolder folder_;
};

std::string said_in(const Checkup& checkup) {
  std::string text;
  for (const Symptom& symptom : checkup.symptoms)
    text += symptom.where + ": " + symptom.what + "\n";
  return text;
}

std::string name_of_format(const testing::TestParamInfo<Format>& format) {
  const BagKind bag = format.param.bag;
  return std::string(bag == BagKind::kNone ? to_string(format.param.layout) : to_string(bag));
}

INSTANTIATE_TEST_SUITE_P(Formats, DoctorOnFormats,
                         testing::Values(Format{DatasetKind::kOpenSceneFlow},
                                         Format{DatasetKind::kNuscenes},
                                         Format{DatasetKind::kHelipr},
                                         Format{DatasetKind::kRecording, BagKind::kMcap},
                                         Format{DatasetKind::kRecording, BagKind::kDb3}),
                         name_of_format);

TEST_P(DoctorOnFormats, IsQuietAboutWhatIsGood) {
  const Checkup checkup = checkup_with(GetParam(), folder_, {});
  EXPECT_EQ(said_in(checkup), "");
  EXPECT_EQ(checkup.kind, GetParam().layout);
  ASSERT_EQ(checkup.sequences.size(), 1U);
  EXPECT_TRUE(checkup.sequences.front().poses);
}

TEST_P(DoctorOnFormats, FindsPosesThatAreAScanLate) {
  EXPECT_THAT(said_in(checkup_with(GetParam(), folder_, with_pose_of_the_scan_before)),
              HasSubstr("the poses fit better as one row later"));
}

TEST(DoctorOnSceneFlow, FindsAFlowThatIsAScanLate) {
  if (!has_hdf5()) GTEST_SKIP() << "this build is without libhdf5";
  if (kSanitized) GTEST_SKIP() << "takes minutes in sanitized builds";
  const TempFolder folder;
  EXPECT_THAT(
      said_in(checkup_with({DatasetKind::kOpenSceneFlow}, folder, with_flow_of_the_scan_before)),
      HasSubstr("the labels do not fit the scans"));
}

}  // namespace
}  // namespace mosbench
