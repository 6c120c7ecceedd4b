#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <thread>

#include "datasets/formats/point_range.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

constexpr double kRad = std::numbers::pi / 180;

struct DriveOptions {
  std::size_t scans = 8, points = 640;
  double step_m = 1, turn_rad = 0, highest_range_m = 60;
};

/// A sensor on a curve and scans of random returns, some of them missing or NaN; made by operations
/// that are the same everywhere.
class RandomDrive : public Sequence {
 public:
  explicit RandomDrive(const DriveOptions& options = {}) : options_(options) {
    Recording& recording = mutable_recording();
    recording.name = SequenceName("drive", "drive");
    Pose pose = Pose::Identity(), step = Pose::Identity();
    step.translation().x() = options.step_m;
    step.linear() = rotation_of({0, 0, options.turn_rad});
    for (std::size_t k = 0; k < options.scans; ++k) {
      recording.scans.push_back({.stem = std::to_string(k),
                                 .file = std::nullopt,
                                 .stamp_ns = 100'000'000 * static_cast<std::int64_t>(k),
                                 .map_from_sensor = pose,
                                 .points = options.points,
                                 .has_truth = k % 2 == 0});
      pose = compose(pose, step);
    }
  }

  using Sequence::read;
  void read(std::size_t k, Frame& frame) const override {
    describe(k, frame);
    frame.points.clear();
    const Draws draws = Draws(7).of(k);
    for (std::size_t i = 0; i < options_.points; ++i) frame.points.push_back(point(draws.of(i)));
    add_truth(k, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t k) const override {
    std::vector<std::uint32_t> truth;
    for (std::size_t i = 0; i < options_.points; ++i) truth.push_back((k + i) % 5 ? 9 : 251);
    return truth;
  }

 private:
  Point point(const Draws& draws) const {
    const double kind = draws.uniform(3);
    if (kind < 0.02) return {0, 0, 0, 0};
    if (kind < 0.03) return {NAN, 1, 1, 0};
    const SinCos azimuth = sin_cos(6.2831853 * draws.uniform(0));
    const SinCos elevation = sin_cos(0.5 * draws.uniform(1) - 0.4);
    const double r = 2 + (options_.highest_range_m - 2) * draws.uniform(2);
    return {static_cast<float>(r * elevation.cos * azimuth.cos),
            static_cast<float>(r * elevation.cos * azimuth.sin),
            static_cast<float>(r * elevation.sin), 0.25F};
  }

  DriveOptions options_;
};

std::unique_ptr<Sequence> drive_with(const std::string& text, const DriveOptions& options = {}) {
  return perturbed(std::make_unique<RandomDrive>(options), parse_perturbation(text));
}

std::string content_of(const Sequence& sequence) {
  ContentFingerprint fingerprint;
  for (std::size_t k = 0; k < sequence.size(); ++k) fingerprint.add(sequence.read(k));
  return fingerprint.hex();
}

/// A text with every kind, each at a strength that shows.
constexpr const char* kEverything =
    "pose_noise_m=0.05,pose_noise_deg=0.2,pose_drift_m=0.01,pose_drift_deg=0.1,pose_jump_m=0.5,"
    "pose_jump_deg=3,range_noise_m=0.02,range_bias_m=-0.1,dropout_probability=0.1,"
    "dropout_per_m=0.001,beams=32,every_nth_scan=2,scan_loss_probability=0.2,stamp_jitter_s=0.004,"
    "rain_mm_per_h=40,fog_per_m=0.02,mount_tilt_deg=2,time_warp=0.9,seed=3";

struct Moments {
  double sum = 0, squares = 0;
  std::size_t count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double mean() const { return sum / static_cast<double>(count); }
  double deviation() const {
    return std::sqrt(squares / static_cast<double>(count) - mean() * mean());
  }
};

/// Mean 0 and this deviation, within five standard errors.
void expect_normal(const Moments& moments, double sigma) {
  ASSERT_GT(moments.count, 1000u);
  const double root = std::sqrt(static_cast<double>(moments.count));
  EXPECT_NEAR(moments.mean(), 0, 5 * sigma / root);
  EXPECT_NEAR(moments.deviation(), sigma, 5 * sigma / (root * std::numbers::sqrt2));
}

Pose noise_of(const Sequence& disturbed, const Sequence& original, std::size_t k) {
  return original.map_from_sensor(k).inverse() * disturbed.map_from_sensor(k);
}

TEST(PortableMath, AgreesWithLibm) {
  const Draws draws(1);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const double x = std::ldexp(0.5 + draws.uniform(i), static_cast<int>(i % 600) - 300);
    EXPECT_NEAR(natural_log(x), std::log(x), 4e-16 * std::max(1.0, std::abs(std::log(x))));
    const double power = 600 * (draws.uniform(i) - 0.5);
    EXPECT_NEAR(exponential(power) / std::exp(power), 1, 1e-15);
    const double a = draws.uniform(2 * i) - 0.5, b = draws.uniform(2 * i + 1) - 0.5;
    EXPECT_NEAR(angle_of(a, b), std::atan2(a, b), 1e-15);
  }
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_EQ(angle_of(0, -1), std::numbers::pi);
  EXPECT_EQ(exponential(-1000), 0);
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(natural_log(1), 0);
}

TEST(PortableMath, TurnsRotationsIntoVectorsAndBack) {
  const Draws draws(2);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Draws own = draws.of(i);
    const Eigen::Vector3d v(own.normal(0), own.normal(1), own.normal(2));
    const Eigen::Vector3d shorter = v * (3.1 * own.of(1).uniform(0) / v.norm());
    const Eigen::Matrix3d rotation = rotation_of(shorter);
    EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LT((rotation_vector(rotation) - shorter).norm(), 1e-13);
  }
}

TEST(Perturbation, WithoutStrengthIsTheIdentity) {
  const RandomDrive original;
  for (const PerturbKind& kind : perturb_kinds()) {
    const bool by_sensor = std::isnan(kind.none);
    const std::string text = std::string(kind.name) + "=" +
                             (by_sensor ? "64" : std::to_string(static_cast<int>(kind.none)));
    const auto disturbed = drive_with(text);
    EXPECT_EQ(disturbed->size(), original.size()) << text;
    EXPECT_EQ(content_of(*disturbed), content_of(original)) << text;
  }
}

TEST(Perturbation, OfEveryKindChangesWhatIsReadAndFollowsItsSeed) {
  const std::string original = content_of(RandomDrive({.turn_rad = 0.05}));
  for (const PerturbKind& kind : perturb_kinds()) {
    const std::string all = kEverything;
    const std::size_t at = all.find(std::string(kind.name) + "=");
    ASSERT_NE(at, std::string::npos) << kind.name;
    const std::string text = all.substr(at, all.find(',', at) - at);
    const std::string once = content_of(*drive_with(text, {.turn_rad = 0.05}));
    EXPECT_NE(once, original) << text;
    EXPECT_EQ(once, content_of(*drive_with(text + ",seed=1", {.turn_rad = 0.05}))) << text;
  }
}

TEST(Perturbation, DependsNeitherOnTheOrderOfScansNorOnThreads) {
  const auto disturbed = drive_with(kEverything, {.scans = 20, .turn_rad = 0.02});
  ASSERT_GT(disturbed->size(), 3u);
  std::vector<Frame> forward;
  for (std::size_t k = 0; k < disturbed->size(); ++k) forward.push_back(disturbed->read(k));
  const auto expect_same = [&](std::size_t k) {
    ContentFingerprint was, is;
    was.add(forward[k]);
    is.add(disturbed->read(k));
    EXPECT_EQ(was.hex(), is.hex()) << k;
  };
  for (std::size_t k = disturbed->size(); k-- > 0;) expect_same(k);
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < disturbed->size(); ++k) {
      threads.emplace_back([&expect_same, k] { expect_same(k); });
    }
  }
}

// Every bit is made by operations that IEEE 754 rounds in one way.
TEST(Perturbation, GivesTheseBitsOnEveryMachine) {
  EXPECT_EQ(content_of(*drive_with(kEverything, {.turn_rad = 0.02})),
            "9a9b908a6fa63b36c17f88b08b441746");
}

TEST(Perturbation, IsRecordedInACanonicalText) {
  const auto disturbed = drive_with(" dropout_probability=0.50 , seed=9,pose_noise_m=1e-1");
  const std::string text = "dropout_probability=0.5,pose_noise_m=0.1,seed=9";
  EXPECT_THAT(members_of(disturbed->reading()), testing::Contains(testing::Pair("perturb", text)));
  EXPECT_THAT(disturbed->remarks(), testing::Contains(HasSubstr(text)));
  EXPECT_EQ(to_string(parse_perturbation(text)), text);
  const std::string everything = to_string(parse_perturbation(kEverything));
  EXPECT_EQ(to_string(parse_perturbation(everything)), everything);
}

TEST(Perturbation, KeepsOneTruthPerPointAndTruthFollowsThePoints) {
  const DriveOptions options{.points = 6400};
  const auto disturbed =
      drive_with("dropout_probability=0.3,fog_per_m=0.05,rain_mm_per_h=60", options);
  const RandomDrive original(options);
  std::size_t lost = 0, scattered = 0;
  for (std::size_t k = 0; k < original.size(); ++k) {
    const Frame was = original.read(k), is = disturbed->read(k);
    ASSERT_EQ(is.points.size(), was.points.size());
    ASSERT_EQ(is.truth.has_value(), was.truth.has_value());
    if (!is.truth) continue;
    EXPECT_EQ(disturbed->read_truth(k), *is.truth);
    for (std::size_t i = 0; i < is.points.size(); ++i) {
      const bool same = std::memcmp(&is.points[i], &was.points[i], sizeof(Point)) == 0;
      EXPECT_EQ((*is.truth)[i], same ? (*was.truth)[i] : 0) << i;
      if (same) continue;
      ++(is_return(is.points[i]) ? scattered : lost);
      EXPECT_LE(range_m(is.points[i]), range_m(was.points[i]) * (1 + 1e-6));
    }
  }
  EXPECT_GT(lost, 300u);
  EXPECT_GT(scattered, 30u);
}

TEST(PoseNoise, HasItsDeviationPerAxisAndIsWhite) {
  const DriveOptions options{.scans = 3000, .points = 0, .turn_rad = 0.1};
  const RandomDrive original(options);
  const auto disturbed = drive_with("pose_noise_m=0.2,pose_noise_deg=0.5", options);
  Moments position_m, rotation_rad, product;
  double before = 0;
  for (std::size_t k = 0; k < original.size(); ++k) {
    const Pose noise = noise_of(*disturbed, original, k);
    for (int axis = 0; axis < 3; ++axis) {
      position_m.add(noise.translation()[axis]);
      rotation_rad.add(rotation_vector(noise.linear())[axis]);
    }
    product.add(before * noise.translation().x());
    before = noise.translation().x();
  }
  expect_normal(position_m, 0.2);
  expect_normal(rotation_rad, 0.5 * kRad);
  EXPECT_NEAR(product.mean(), 0, 5 * 0.2 * 0.2 / std::sqrt(3000.0));
}

TEST(PoseDrift, GrowsWithTheRootOfTheWay) {
  const DriveOptions options{.scans = 26, .points = 0, .step_m = 4};
  const RandomDrive original(options);
  Moments middle_m, end_m;
  for (int seed = 0; seed < 500; ++seed) {
    const auto disturbed = drive_with("pose_drift_m=0.1,seed=" + std::to_string(seed), options);
    EXPECT_EQ(disturbed->map_from_sensor(0).matrix(), original.map_from_sensor(0).matrix());
    for (int axis = 0; axis < 3; ++axis) {
      middle_m.add(noise_of(*disturbed, original, 9).translation()[axis]);
      end_m.add(noise_of(*disturbed, original, 25).translation()[axis]);
    }
  }
  expect_normal(middle_m, 0.1 * std::sqrt(36.0));
  expect_normal(end_m, 0.1 * std::sqrt(100.0));
}

TEST(PoseDrift, OfRotationNeedsTurns) {
  const DriveOptions straight{.scans = 10, .points = 0};
  const auto unturned = drive_with("pose_drift_deg=1", straight);
  EXPECT_LT(rotation_vector(unturned->map_from_sensor(9).linear()).norm(), 1e-12);
  const DriveOptions turning{.scans = 2, .points = 0, .turn_rad = 16 * kRad};
  Moments rotation_rad;
  for (int seed = 0; seed < 500; ++seed) {
    const auto disturbed = drive_with("pose_drift_deg=0.1,seed=" + std::to_string(seed), turning);
    const Pose noise = noise_of(*disturbed, RandomDrive(turning), 1);
    for (int axis = 0; axis < 3; ++axis) rotation_rad.add(rotation_vector(noise.linear())[axis]);
  }
  expect_normal(rotation_rad, 0.1 * 4 * kRad);
}

TEST(PoseJump, MovesAllPosesFromItsScanOnByOneMotionOfTheMap) {
  const DriveOptions options{.scans = 10, .points = 0, .turn_rad = 0.1};
  const RandomDrive original(options);
  const auto disturbed = drive_with("pose_jump_m=0.7,pose_jump_deg=-5,pose_jump_scan=4", options);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(disturbed->map_from_sensor(k).matrix(), original.map_from_sensor(k).matrix());
  }
  const Pose jump = disturbed->map_from_sensor(4) * original.map_from_sensor(4).inverse();
  const Eigen::Vector3d moved =
      disturbed->map_from_sensor(4).translation() - original.map_from_sensor(4).translation();
  EXPECT_NEAR(moved.norm(), 0.7, 1e-12);
  EXPECT_EQ(moved.z(), 0);
  EXPECT_LT((rotation_vector(jump.linear()) - Eigen::Vector3d(0, 0, -5 * kRad)).norm(), 1e-12);
  for (std::size_t k = 5; k < 10; ++k) {
    EXPECT_LT(
        (disturbed->map_from_sensor(k).matrix() - (jump * original.map_from_sensor(k)).matrix())
            .norm(),
        1e-12);
  }
  const auto message =
      message_of<UsageError>([&] { drive_with("pose_jump_m=1,pose_jump_scan=10", options); });
  EXPECT_THAT(message, HasSubstr("expected 0 to 9"));
}

TEST(RangeNoise, HasItsDeviationAlongTheRay) {
  const RandomDrive original;
  const auto disturbed = drive_with("range_noise_m=0.1");
  Moments moments;
  for (std::size_t k = 0; k < original.size(); ++k) {
    const Frame was = original.read(k), is = disturbed->read(k);
    for (std::size_t i = 0; i < was.points.size(); ++i) {
      if (!is_return(was.points[i])) continue;
      const double r = range_m(was.points[i]), now = range_m(is.points[i]);
      moments.add(now - r);
      EXPECT_NEAR(is.points[i].x / now, was.points[i].x / r, 1e-6);
      EXPECT_NEAR(is.points[i].z / now, was.points[i].z / r, 1e-6);
      EXPECT_EQ(is.points[i].intensity, was.points[i].intensity);
    }
  }
  expect_normal(moments, 0.1);
}

TEST(RangeBias, IsAddedAndStopsShortOfTheSensor) {
  const Frame was = RandomDrive().read(0);
  const Frame farther = drive_with("range_bias_m=0.5")->read(0);
  const Frame nearer = drive_with("range_bias_m=-10")->read(0);
  std::size_t stopped = 0;
  for (std::size_t i = 0; i < was.points.size(); ++i) {
    if (!is_return(was.points[i])) continue;
    const double r = range_m(was.points[i]);
    EXPECT_NEAR(range_m(farther.points[i]), r + 0.5, 1e-5);
    EXPECT_NEAR(range_m(nearer.points[i]), std::max(0.01, r - 10), 1e-5);
    stopped += r < 10;
  }
  EXPECT_GT(stopped, 20u);
}

// The second bias meets what the first left, so that their order counts.
TEST(Perturbation, IsAppliedInTheOrderGiven) {
  const Frame was = RandomDrive().read(0);
  const Frame out_and_in = drive_with("range_bias_m=5,range_bias_m=-5")->read(0);
  const Frame in_and_out = drive_with("range_bias_m=-5,range_bias_m=5")->read(0);
  std::size_t stopped = 0;
  for (std::size_t i = 0; i < was.points.size(); ++i) {
    if (!is_return(was.points[i])) continue;
    const double r = range_m(was.points[i]);
    EXPECT_NEAR(range_m(out_and_in.points[i]), r, 1e-5);
    EXPECT_NEAR(range_m(in_and_out.points[i]), std::max(r, 5.01), 1e-5);
    stopped += r < 5;
  }
  EXPECT_GT(stopped, 10u);
  EXPECT_EQ(drive_with("every_nth_scan=2,every_nth_scan=3", {.scans = 20})->stem(3), "18");
}

std::pair<std::size_t, std::size_t> lost_and_seen(const Sequence& disturbed,
                                                  const Sequence& original, double from_m,
                                                  double to_m) {
  std::size_t lost = 0, seen = 0;
  for (std::size_t k = 0; k < original.size(); ++k) {
    const Frame was = original.read(k), is = disturbed.read(k);
    for (std::size_t i = 0; i < was.points.size(); ++i) {
      if (!is_return(was.points[i])) continue;
      const double r = range_m(was.points[i]);
      if (r < from_m || r >= to_m) continue;
      ++seen;
      lost += !is_return(is.points[i]);
    }
  }
  return {lost, seen};
}

void expect_share(std::pair<std::size_t, std::size_t> lost_of_seen, double share, double slack) {
  const double seen = static_cast<double>(lost_of_seen.second);
  ASSERT_GT(seen, 300);
  EXPECT_NEAR(static_cast<double>(lost_of_seen.first) / seen, share,
              slack + 5 * std::sqrt(share * (1 - share) / seen));
}

TEST(Dropout, LosesItsShareOfReturns) {
  const RandomDrive original;
  expect_share(lost_and_seen(*drive_with("dropout_probability=0.3"), original, 0, 100), 0.3, 0);
  const auto all = lost_and_seen(*drive_with("dropout_probability=1"), original, 0, 100);
  EXPECT_EQ(all.first, all.second);
  const auto by_range = drive_with("dropout_per_m=0.02");
  for (const double from_m : {5.0, 25.0, 50.0}) {
    expect_share(lost_and_seen(*by_range, original, from_m, from_m + 10),
                 1 - std::exp(-0.02 * (from_m + 5)), 0.02);
  }
}

TEST(Beams, KeepEveryNthOfAColumn) {
  const Frame was = RandomDrive().read(1);
  const Frame is = drive_with("beams=16,beams_of=64")->read(1);
  for (std::size_t i = 0; i < was.points.size(); ++i) {
    const bool kept = i % 64 % 4 == 0 || !is_return(was.points[i]);
    EXPECT_EQ(std::memcmp(&is.points[i], &was.points[i], sizeof(Point)) == 0, kept) << i;
  }
}

/// One simulated scan, which has columns and known elevations.
class OneScan : public Sequence {
 public:
  explicit OneScan(Frame frame) : frame_(std::move(frame)) {
    mutable_recording().name = SequenceName("one", "one");
    ScanEntry& scan = mutable_recording().scans.emplace_back();
    scan.stem = "0";
    scan.points = frame_.points.size();
  }
  using Sequence::read;
  void read(std::size_t, Frame& frame) const override { frame = frame_; }
  std::vector<std::uint32_t> read_truth(std::size_t) const override { return *frame_.truth; }

 private:
  Frame frame_;
};

TEST(Beams, AreTheSameByElevationAndByColumn) {
  const Frame frame = built_in_simulator("street", "vlp-16", 1).frame(0);
  const auto content = [&](const std::string& text) {
    return content_of(*perturbed(std::make_unique<OneScan>(frame), parse_perturbation(text)));
  };
  const std::string by_column = content("beams=4,beams_of=16");
  EXPECT_EQ(content("beams=4,beams_of=16,beams_top_deg=15,beams_bottom_deg=-15"), by_column);
  EXPECT_NE(content("beams=8,beams_of=16"), by_column);
  Frame shorter = frame;
  shorter.points.pop_back();
  EXPECT_THAT(message_of<UsageError>([&] {
                perturbed(std::make_unique<OneScan>(shorter),
                          parse_perturbation("beams=4,beams_of=16"));
              }),
              HasSubstr("beams_top_deg"));
}

TEST(LostScans, LeaveTheOthersAsTheyWere) {
  const DriveOptions options{.scans = 2000, .points = 16};
  const auto all = drive_with("pose_noise_m=0.1,range_noise_m=0.1", options);
  const auto left =
      drive_with("pose_noise_m=0.1,range_noise_m=0.1,scan_loss_probability=0.25", options);
  EXPECT_EQ(left->stem(0), "0");
  EXPECT_NEAR(static_cast<double>(left->size()), 1500, 5 * std::sqrt(2000 * 0.25 * 0.75));
  for (std::size_t k = 0; k < left->size(); k += 50) {
    ContentFingerprint is, was;
    is.add(left->read(k));
    was.add(all->read(std::stoul(left->stem(k))));
    EXPECT_EQ(is.hex(), was.hex()) << left->stem(k);
  }
  EXPECT_EQ(drive_with("scan_loss_probability=1", options)->size(), 1u);
}

TEST(Stamps, JitterButKeepTheirOrder) {
  const DriveOptions options{.scans = 3000, .points = 0};
  const RandomDrive original(options);
  Moments noise_s;
  const auto jittered = drive_with("stamp_jitter_s=0.005", options);
  const auto wild = drive_with("stamp_jitter_s=9", options);
  for (std::size_t k = 0; k < original.size(); ++k) {
    noise_s.add(1e-9 * static_cast<double>(*jittered->stamp_ns(k) - *original.stamp_ns(k)));
    EXPECT_LE(std::abs(*wild->stamp_ns(k) - *original.stamp_ns(k)), 49'000'000);
    EXPECT_TRUE(k == 0 || *wild->stamp_ns(k) > *wild->stamp_ns(k - 1)) << k;
  }
  expect_normal(noise_s, 0.005);
}

TEST(Fog, LosesWhatIsTooWeakAndHidesWhatIsFar) {
  const DriveOptions options{.highest_range_m = 110};
  const RandomDrive original(options);
  std::size_t seen_before = 1'000'000;
  for (const double per_m : {0.005, 0.02, 0.06}) {
    const auto foggy = drive_with("fog_per_m=" + std::to_string(per_m), options);
    std::size_t seen = 0;
    for (std::size_t k = 0; k < original.size(); ++k) {
      const Frame was = original.read(k), is = foggy->read(k);
      for (std::size_t i = 0; i < was.points.size(); ++i) {
        if (!is_return(was.points[i])) continue;
        const double r = range_m(was.points[i]);
        const bool strong = r * r * std::exp(2 * per_m * r) <= 120.0 * 120.0;
        const bool same = range_m(is.points[i]) == r;
        seen += same;
        EXPECT_TRUE(strong || !same) << r;
        EXPECT_TRUE(same || range_m(is.points[i]) <= std::min(r, 31.0)) << r;
        EXPECT_TRUE(same || r >= 10) << r;
      }
    }
    EXPECT_LT(seen, seen_before);
    seen_before = seen;
  }
  EXPECT_GT(seen_before, 300u);
}

TEST(Rain, ScattersMoreTheHarderItRains) {
  const DriveOptions options{.points = 6400, .highest_range_m = 80};
  const RandomDrive original(options);
  std::size_t drops_before = 0;
  for (const char* rate : {"2", "20", "100"}) {
    const auto rainy = drive_with(std::string("rain_mm_per_h=") + rate, options);
    std::size_t drops = 0, seen = 0;
    for (std::size_t k = 0; k < original.size(); ++k) {
      const Frame was = original.read(k), is = rainy->read(k);
      for (std::size_t i = 0; i < was.points.size(); ++i) {
        if (!is_return(was.points[i])) continue;
        const double r = range_m(was.points[i]), now = range_m(is.points[i]);
        ++seen;
        if (!is_return(is.points[i]) || now == r) continue;
        ++drops;
        EXPECT_GE(now, 1.5 - 1e-5);
        EXPECT_LT(now, std::min(r, 20.0));
      }
    }
    EXPECT_GT(drops, drops_before) << rate;
    EXPECT_LT(drops, seen / 4);
    drops_before = drops;
  }
}

TEST(MountTilt, TurnsWhatIsAheadUpAndKeepsRanges) {
  const Frame was = RandomDrive().read(0), is = drive_with("mount_tilt_deg=10")->read(0);
  const Frame back = drive_with("mount_tilt_deg=10,mount_tilt_deg=-10")->read(0);
  for (std::size_t i = 0; i < was.points.size(); ++i) {
    if (!is_return(was.points[i])) continue;
    const Point &a = was.points[i], &b = is.points[i], &c = back.points[i];
    EXPECT_NEAR(range_m(b), range_m(a), 1e-5);
    EXPECT_NEAR(b.z, a.x * std::sin(10 * kRad) + a.z * std::cos(10 * kRad), 1e-5);
    EXPECT_EQ(b.y, a.y);
    EXPECT_NEAR(c.x, a.x, 1e-5);
    EXPECT_NEAR(c.z, a.z, 1e-5);
  }
}

TEST(TimeWarp, IsUndoneByUndistortion) {
  const DriveOptions options{.step_m = 2, .turn_rad = 0.08};
  const RandomDrive original(options);
  const auto warped = drive_with("time_warp=1", options);
  double farthest_m = 0;
  for (const std::size_t k : {std::size_t{0}, std::size_t{3}, original.size() - 1}) {
    const Frame was = original.read(k), is = warped->read(k);
    for (std::size_t i = 0; i < was.points.size(); ++i) {
      const Point &a = was.points[i], &b = is.points[i];
      if (!is_return(a)) continue;
      const double share = -std::atan2(a.y, a.x) / (2 * std::numbers::pi);
      Pose moved = Pose::Identity();  // of the constant motion
      moved.linear() = rotation_of({0, 0, 0.08 * share});
      moved.translation() =
          std::abs(share) *
          (share < 0 ? Eigen::Vector3d(rotation_of({0, 0, -0.08}) * Eigen::Vector3d(-2, 0, 0))
                     : Eigen::Vector3d(2, 0, 0));
      const Eigen::Vector3d p = moved * Eigen::Vector3d(b.x, b.y, b.z);
      EXPECT_LT((p - Eigen::Vector3d(a.x, a.y, a.z)).norm(), 1e-4) << k << " " << i;
      farthest_m = std::max(
          farthest_m, (Eigen::Vector3d(b.x, b.y, b.z) - Eigen::Vector3d(a.x, a.y, a.z)).norm());
    }
  }
  EXPECT_GT(farthest_m, 0.8);
}

TEST(PerturbationText, IsRefusedWithWhatWasExpected) {
  const auto error = [](const char* text) {
    return message_of<UsageError>([&] { parse_perturbation(text); });
  };
  EXPECT_THAT(error("pose_nois_m=1"), HasSubstr("nearest: pose_noise_m"));
  EXPECT_THAT(error("pose_noise_m"), HasSubstr("has no value"));
  EXPECT_THAT(error(""), HasSubstr("has no value"));
  EXPECT_THAT(error("pose_noise_m=-1"), HasSubstr("a number from 0"));
  EXPECT_THAT(error("pose_noise_m=nan"), HasSubstr("a number from 0"));
  EXPECT_THAT(error("dropout_probability=1.01"), HasSubstr("a number from 0 to 1"));
  EXPECT_THAT(error("every_nth_scan=1.5"), HasSubstr("a whole number"));
  EXPECT_THAT(error("seed=-1"), HasSubstr("a whole number"));
  EXPECT_THAT(error("seed=1,seed=2"), HasSubstr("given twice"));
  EXPECT_THAT(error("beams=48"), HasSubstr("a divisor of beams_of"));
  EXPECT_THAT(error("seed=3"), HasSubstr("no disturbance is given"));
  EXPECT_THAT(error("beams_of=32,fog_per_m=0.1"), HasSubstr("expected it with beams"));
  EXPECT_THAT(error("pose_jump_scan=3,pose_noise_m=1"), HasSubstr("pose_jump_m or pose_jump_deg"));
  EXPECT_THAT(error("sensor_range_m=90,beams=32"), HasSubstr("rain_mm_per_h or fog_per_m"));
  EXPECT_THAT(error("beams=32,beams_top_deg=3"), HasSubstr("both of them"));
  EXPECT_THAT(error("beams=32,beams_top_deg=3,beams_bottom_deg=4"), HasSubstr("top to bottom"));
}

}  // namespace
}  // namespace mosbench
