#include "core/methods/hmm_mos/voxel_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tests/small_world.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

struct TripleHash {
  std::size_t operator()(const Triple& v) const {
    return static_cast<std::size_t>((v[0] * 1009 + v[1]) * 1013 + v[2]);
  }
};

/// The update and eviction of the paper's map (III) on single voxels.
class MapTwin {
 public:
  MapTwin(const Config& config, Variant variant) : config_(config), variant_(variant) {}

  void update(const Triples& observed, const Triples& sources, int k) {
    const double e = config_.transition_epsilon;
    for (const Triple& v : observed) {
      double distance_sq_m2 = 1e18;
      for (const Triple& u : sources) distance_sq_m2 = std::min(distance_sq_m2, apart_sq_m2(u, v));
      const double likelihood =
          std::exp(-distance_sq_m2 / (2 * config_.sigma_m() * config_.sigma_m()));
      Record& r = records_[v];
      const double occupied = likelihood * (e * r.unobserved + (1 - e) * r.occupied + e * r.free);
      const double free = (1 - likelihood) * (e * r.unobserved + e * r.occupied + (1 - e) * r.free);
      r.unobserved = 0;
      r.occupied = occupied / (occupied + free);
      r.free = free / (occupied + free);
      const char state = r.free > r.occupied ? 'f' : 'o';
      if (std::max(r.free, r.occupied) > config_.min_state_probability) {
        if (r.state != 'u' && r.state != state) r.last_change = k;
        r.state = state;
      }
      r.last_seen = k;
    }
  }

  void evict(const Eigen::Vector3d& sensor_m, int k) {
    const double factor = variant_ == Variant::kPaper2024 ? 2.0 : 1.5;
    const int w_g = config_.global_window_scans;
    std::erase_if(records_, [&](const auto& entry) {
      const auto& [v, r] = entry;
      const Eigen::Vector3d corner_m =
          Eigen::Vector3d(v[0], v[1], v[2]) * config_.voxel_size_m - sensor_m;
      const bool far = corner_m.squaredNorm() > std::pow(factor * config_.max_range_m, 2);
      const bool old =
          r.last_seen < k - w_g && (variant_ == Variant::kPaper2024 ? k > w_g : r.last_seen > w_g);
      ranged_out += far;
      expired += old && !far;
      return far || old;
    });
  }

  bool known(const Triple& v, int k) const {
    const auto found = records_.find(v);
    return found != records_.end() && found->second.state != 'u' &&
           k - found->second.last_seen < config_.global_window_scans;
  }
  bool changed_since(const Triple& v, int first) const {
    const auto found = records_.find(v);
    return found != records_.end() && found->second.last_change >= first;
  }
  bool has_record(const Triple& v) const { return records_.contains(v); }

  std::size_t ranged_out = 0, expired = 0;

 private:
  struct Record {
    double unobserved = 1, occupied = 0, free = 0;
    char state = 'u';
    int last_change = 0, last_seen = 0;
  };

  double apart_sq_m2(const Triple& a, const Triple& b) const {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return (x * x + y * y + z * z) * config_.voxel_size_m * config_.voxel_size_m;
  }

  Config config_;
  Variant variant_;
  std::unordered_map<Triple, Record, TripleHash> records_;
};

struct Journey {
  Config config;
  Variant variant = Variant::kPaper2024;
  double step_m = 0.05;
  double jump_m = 0.0;  ///< in one of eight scans
  unsigned threads = 1;
  unsigned seed = 1;
  int scans = 120;
};

struct Seen {
  std::size_t known = 0, unknown = 0, changed = 0, ranged_out = 0, expired = 0;
};

/// Scans that see some of 400 fixed places each; known and changed are compared wherever
/// detection might ask: within range of the sensor now and `delay` scans ago.
void expect_equal_to_twin(const Journey& journey, Seen& seen) {
  const Config& config = journey.config;
  std::mt19937 random(journey.seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const VoxelGrid grid{.voxel_size_m = config.voxel_size_m};
  VoxelMap map(of_variant(config, journey.variant), grid);
  MapTwin twin(config, journey.variant);
  ThreadPool pool(journey.threads);
  const Triples places = random_triples(random, 700, 22);
  std::vector<Eigen::Vector3d> sensors_m;
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
  const Eigen::Vector3d step_m =
      Eigen::Vector3d(uniform() - 0.5, uniform() - 0.5, uniform() - 0.5).normalized() *
      journey.step_m;
  for (int k = 0; k < journey.scans; ++k) {
    sensor_m += k % 60 < 30 ? step_m : Eigen::Vector3d(-step_m);
    sensors_m.push_back(sensor_m);
    if (random() % 8 == 0) sensors_m.back().x() += journey.jump_m;
    Triples observed, sources;
    for (const Triple& v : places) {
      const Eigen::Vector3d offset_m =
          Eigen::Vector3d(v[0], v[1], v[2]) * config.voxel_size_m - sensors_m.back();
      if (offset_m.norm() > config.max_range_m) continue;
      if ((static_cast<unsigned>(v[0] + 50) + static_cast<unsigned>(k) / 7) % 3 == 0) continue;
      if (uniform() < 0.4) observed.insert(v);
      if (uniform() < 0.2) sources.insert(v);
    }
    const VoxelSet observed_set = voxel_set(observed), first = voxel_set(sources);
    const VoxelSet second = voxel_set({{20, 20, 20}, {-300, 0, 0}});
    sources.insert({20, 20, 20});
    sources.insert({-300, 0, 0});
    const std::vector<const VoxelSet*> both{&first, &second};
    const auto scan_index = static_cast<std::uint32_t>(k);
    map.update({observed_set.blocks, observed_set.masks}, both, sensors_m.back(), scan_index, pool);
    twin.update(observed, sources, k);
    map.evict(scan_index);
    twin.evict(sensors_m.back(), k);

    const int first_scan = std::max(1, k - config.delay_scans);
    const VoxelSet changed = map.changed_since(static_cast<std::uint32_t>(first_scan));
    const VoxelSet known_voxels = map.known_at(scan_index, voxel_set(places).blocks, pool);
    const auto delayed = static_cast<std::size_t>(std::max(0, k - config.delay_scans));
    for (const Triple& v : places) {
      const Eigen::Vector3d corner_m = Eigen::Vector3d(v[0], v[1], v[2]) * config.voxel_size_m;
      if ((corner_m - sensors_m.back()).norm() > config.max_range_m &&
          (corner_m - sensors_m[delayed]).norm() > config.max_range_m) {
        continue;
      }
      const Voxel voxel{v[0], v[1], v[2]};
      const bool known = known_voxels.contains(voxel);
      ASSERT_EQ(known, twin.known(v, k)) << "scan " << k;
      if (twin.has_record(v)) {
        ASSERT_EQ(changed.contains(voxel), twin.changed_since(v, first_scan)) << "scan " << k;
        seen.changed += changed.contains(voxel);
      }
      (known ? seen.known : seen.unknown) += 1;
    }
  }
  seen.ranged_out += twin.ranged_out;
  seen.expired += twin.expired;
}

Config journey_config() {
  Config config;
  config.voxel_size_m = 0.25;
  config.max_range_m = 3.0;
  config.kernel_width_voxels = 1;
  return config;
}

TEST(VoxelMap, EqualsAnUnorderedMapOverRandomScans) {
  Seen seen;
  unsigned seed = 100;
  for (const Variant variant : {Variant::kPaper2024, Variant::kRelease2025}) {
    for (const int w_g : {1, 3, 10, 300}) {
      for (const int delay : {0, 4}) {
        if (variant == Variant::kRelease2025 && delay != 0) continue;
        Journey journey{.config = journey_config(), .variant = variant, .seed = ++seed};
        journey.config.global_window_scans = w_g;
        if (w_g < 10) journey.scans = 300;  // numbers of scans wrap round in 128 or 256
        journey.config.delay_scans = delay;
        journey.config.min_state_probability = w_g == 3 ? 0.7 : 0.99;
        journey.threads = seed % 3 + 1;
        expect_equal_to_twin(journey, seen);
      }
    }
  }
  EXPECT_GT(seen.known, 10'000U);
  EXPECT_GT(seen.unknown, 10'000U);
  EXPECT_GT(seen.changed, 2000U);
  EXPECT_GT(seen.expired, 1000U);
}

TEST(VoxelMap, ForgetsWhatTheSensorLeftBehind) {
  Seen seen;
  unsigned seed = 200;
  for (const Variant variant : {Variant::kPaper2024, Variant::kRelease2025}) {
    for (const double jump_m : {0.0, 2.0, 4.0, 7.0, 50.0}) {
      for (const double step_m : {0.02, 0.2, 1.0}) {
        Journey journey{.config = journey_config(),
                        .variant = variant,
                        .step_m = step_m,
                        .jump_m = jump_m,
                        .seed = ++seed};
        journey.config.delay_scans = variant == Variant::kPaper2024 && seed % 2 == 0 ? 3 : 0;
        journey.config.max_range_m = 2.0;
        expect_equal_to_twin(journey, seen);
      }
    }
  }
  EXPECT_GT(seen.ranged_out, 1000U);
  EXPECT_GT(seen.known, 10'000U);
}

TEST(VoxelMap, EqualsTheTwinForWideSigma) {
  Seen seen;
  for (const double ratio : {0.3, 2.0, 4.0}) {
    Journey journey{.config = journey_config(), .seed = 300};
    journey.config.occupancy_sigma_m = ratio * journey.config.voxel_size_m;
    journey.config.min_state_probability = 0.8;
    expect_equal_to_twin(journey, seen);
  }
  EXPECT_GT(seen.known, 5000U);
}

/// Observes one voxel and returns whether it is known.
class OneVoxel {
 public:
  OneVoxel(int w_g, Variant variant)
      : map_(of_variant(config(w_g), variant), VoxelGrid{.voxel_size_m = 0.2}) {}

  void scan(std::uint32_t k, bool see) {
    const VoxelSet seen = see ? voxel_set({{1, 2, 3}}) : VoxelSet{};
    map_.update({seen.blocks, seen.masks}, {}, Eigen::Vector3d::Zero(), k, pool_);
    map_.evict(k);
  }
  bool known(std::uint32_t k) {
    return map_.known_at(k, std::vector{BlockIndex{0, 0, 0}}, pool_).contains({1, 2, 3});
  }
  std::size_t blocks() const { return map_.block_count(); }

 private:
  static Config config(int w_g) {
    Config config;
    config.global_window_scans = w_g;
    return config;
  }
  ThreadPool pool_{1};
  VoxelMap map_;
};

TEST(VoxelMap, RecordOfAgeWgExistsButIsNotKnown) {
  OneVoxel map(5, Variant::kPaper2024);
  map.scan(0, true);
  for (std::uint32_t k = 1; k <= 5; ++k) {
    map.scan(k, false);
    EXPECT_EQ(map.known(k), k < 5) << k;
  }
  EXPECT_EQ(map.blocks(), 1U);
  for (std::uint32_t k = 6; k <= 6 + 16; ++k) map.scan(k, false);
  EXPECT_EQ(map.blocks(), 0U) << "expired blocks have to be given back";
}

TEST(VoxelMap, Release2025NeverForgetsTheFirstScansButForgetsLaterOnes) {
  OneVoxel early(5, Variant::kRelease2025), late(5, Variant::kRelease2025);
  for (std::uint32_t k = 0; k < 100; ++k) {
    early.scan(k, k == 5);
    late.scan(k, k == 6);
  }
  EXPECT_EQ(early.blocks(), 1U);
  EXPECT_FALSE(early.known(99));
  EXPECT_EQ(late.blocks(), 0U);
}

}  // namespace
}  // namespace mosbench
