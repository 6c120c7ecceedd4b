#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "bench/near_blocks.hpp"
#include "bench/stage_benchmark.hpp"
#include "core/methods/hmm_mos/change_detection.hpp"
#include "core/methods/hmm_mos/median.hpp"
#include "core/methods/hmm_mos/otsu.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"

namespace mosbench {
namespace {

/// Measures a stage with memory: each pass calls `begin(first)`, which takes in the scans before
/// `first` and returns the function that measures one scan and tells whether its result is right.
template <typename Begin>
void measure_with_memory(benchmark::State& state, StagedScans& staged, Begin&& begin) {
  bool right = true;
  measure_passes(state, staged.measured.size(), [&] {
    auto step = begin(staged.measured.front().k);
    for (const StagedScan& s : staged.measured) {
      staged.run_other_stages();
      right = step(s) && right;
    }
  });
  expect(state, right);
}

void voxelize_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return voxelize(s.frame.points, s.frame.map_from_sensor, staged.grid, config.min_range_m,
                        config.max_range_m, pool);
      },
      [](const StagedScan& s, const VoxelizedScan& scan) {
        return scan.measured.masks == s.scan.measured.masks && scan.occupied == s.scan.occupied &&
               scan.voxel_of_point == s.scan.voxel_of_point;
      });
  count_items(state, "points", mean_points(staged));
}

/// Counts the voxels that rays visit, counted once per ray.
std::size_t steps_of(const StagedScan& s, const Config& config) {
  Rays rays;
  collect_rays({s.scan.measured, s.scan.sensor_voxel, config.voxel_size_m, config.max_range_m}, {},
               0, rays);  // no ray is short
  std::size_t steps = 0;
  for (const Ray& ray : rays.long_rays) steps += static_cast<std::size_t>(ray.visits);
  return steps;
}

void raycast_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const Config& config = staged.workload.config;
  RaycastScratch scratch;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return raycast(ray_sources(s.scan, config.voxel_size_m, config.max_range_m), scratch, pool);
      },
      [](const StagedScan& s, const VoxelList& observed) {
        return voxels_of(observed) == voxels_of(s.observed);
      });
  count_items(state, "steps",
              mean_of(staged, [&](const StagedScan& s) { return steps_of(s, config); }));
  state.counters["voxels"] = static_cast<double>(mean_observed(staged));
}

void distance_field_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const NearBlocks near(staged);
  BlockDistances distances;
  std::size_t blocks = 0;
  for (auto _ : state) {
    blocks = 0;
    ColumnDistances column(near.field());
    for (std::size_t i = 0; i < near.size(); ++i) {
      near.find_distances(i, column, distances);
      blocks += distances.near.any();
      benchmark::DoNotOptimize(distances);
    }
  }
  count_items(state, "blocks", near.size());
  expect(state, blocks == near.with_source() && near.equals_all_pairs());
}

/// Returns the belief of a voxel whose squared distance was `squared` voxels in each of many scans.
double settled_belief(const Config& config, double squared) {
  const double ratio = config.voxel_size_m / config.sigma_m(), epsilon = config.transition_epsilon;
  const double likelihood = std::exp(-squared * ratio * ratio / 2);
  double p = likelihood;
  for (int scan = 0; scan < 100; ++scan) {
    const double q = epsilon + (1 - 2 * epsilon) * p;
    p = likelihood * q / (likelihood * q + (1 - likelihood) * (1 - q));
  }
  return p;
}

void hmm_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const NearBlocks near(staged);
  std::vector<BlockDistances> distances(near.size());
  std::vector<BlockBeliefs> beliefs(near.size());
  std::vector<BeliefNumbers> numbers(near.size());
  std::vector<BlockStates> states(near.size());
  std::size_t voxels = 0;
  ColumnDistances column(near.field());
  for (std::size_t i = 0; i < near.size(); ++i) {
    near.find_distances(i, column, distances[i]);
    voxels += near.observed(i).count();
  }
  const auto update = [&] {
    for (std::size_t i = 0; i < near.size(); ++i) {
      near.filter().update(near.observed(i), distances[i], beliefs[i], numbers[i], states[i]);
    }
  };
  for (int scan = 0; scan < 100; ++scan) update();
  for (auto _ : state) update();
  count_items(state, "voxels", voxels);
  for (std::size_t i = 0; i < near.size(); ++i) {
    for_each_cell(near.observed(i) & distances[i].near, [&](std::uint32_t cell) {
      const double expected = settled_belief(staged.workload.config, distances[i].squared[cell]);
      expect(state, std::abs(beliefs[i].at(cell, numbers[i]) - expected) < 1e-3);
    });
  }
}

void map_update_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  measure_with_memory(state, staged, [&](std::size_t first) {
    return [&, map = staged.map_after(first, pool)](const StagedScan& s) mutable {
      const StagedScan inputs = s;
      const VoxelList changed = timed_call(state, [&] { return staged.update(map, inputs, pool); });
      map.evict(s.k);
      return voxels_of(changed) == s.state_changes;
    };
  });
  count_items(state, "voxels", mean_observed(staged));
  const VoxelMap last = staged.map_after(staged.all.size(), pool);
  state.counters["bytes/map voxel"] = static_cast<double>(last.memory_bytes()) /
                                      static_cast<double>(last.block_count() * kBlockVoxels);
}

/// One call is one scan; in sixteen scans every block is visited once.
void evict_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  constexpr std::uint32_t kScans = 16;
  const std::uint32_t k = staged.last().k;
  VoxelMap map = staged.map_after(k + 1, pool);
  const std::size_t blocks = map.block_count();
  measure_passes(state, kScans, [&] {
    for (std::uint32_t i = 0; i < kScans; ++i) {
      staged.run_other_stages();
      timed_call(state, [&] { return map.evict(k + i), 0; });
    }
  });
  count_items(state, "blocks", blocks / kScans);
  expect(state, map.block_count() == blocks);
  // Once everything has expired every block goes.
  const auto late = k + static_cast<std::uint32_t>(staged.workload.config.global_window_scans) + 2;
  for (std::uint32_t i = 0; i < kScans; ++i) map.evict(late + i);
  expect(state, map.block_count() == 0);
}

/// In every block the occupied voxels change from this scan's to the previous scan's.
void change_detection_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  std::vector<BlockStates> before, after;
  std::size_t expected = 0;
  const VoxelList& list = staged.last().observed;
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    const auto occupied = [&](const StagedScan& s) {
      const BlockMask* mask = s.scan.occupied_in(list.blocks[i]);
      return mask == nullptr ? BlockMask{} : *mask & list.masks[i];
    };
    const BlockMask here = occupied(staged.last()), there = occupied(staged.last_but_one());
    before.push_back({here, without(list.masks[i], here)});
    after.push_back({there, without(list.masks[i], there)});
    expected += without(here, there).count() + without(there, here).count();
  }
  std::size_t changed = 0;
  for (auto _ : state) {
    changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      changed += detect_changes(before[i], after[i]).count();
    }
    benchmark::DoNotOptimize(changed);
    benchmark::ClobberMemory();
  }
  count_items(state, "voxels", before.size() * kBlockVoxels);
  expect(state, changed == expected);
}

/// Measures on a map that was just updated, as in the pipeline.
void convolution_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  measure_with_memory(state, staged, [&](std::size_t first) {
    return [&, width, map = staged.map_after(first, pool)](const StagedScan& s) mutable {
      staged.enter(map, s, pool);
      const VoteField votes = timed_call(state, [&] { return votes_for(s, map, width, pool); });
      return votes.values == s.votes.values;
    };
  });
  count_items(state, "voxels", mean_occupied(staged));
}

void median_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  measure_stage(
      state, staged, [&](const StagedScan& s) { return median_filter(s.scan, s.votes, pool); },
      [](const StagedScan& s, const VoteField& filtered) {
        return filtered.values == s.filtered.values;
      });
  count_items(state, "voxels", mean_occupied(staged));
}

/// Compares the sums at occupied voxels; others have no meaning.
bool same_sums(const SumField& sums, const StagedScan& s) {
  bool same = sums.values.size() == s.sums.values.size();
  for (std::size_t i = 0; same && i < sums.blocks.size(); ++i) {
    for_each_cell(*s.scan.occupied_in(sums.blocks[i]), [&](std::uint32_t cell) {
      same = same && sums.values[i][cell] == s.sums.values[i][cell];
    });
  }
  return same;
}

void window_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  measure_with_memory(state, staged, [&](std::size_t first) {
    LocalWindow window(staged.workload.config.local_window_scans);
    for (std::size_t k = 0; k < first; ++k) window.join(staged.all[k].filtered);
    return [&, window = std::move(window)](const StagedScan& s) mutable {
      VoteField filtered = s.filtered;
      const VoxelizedScan scan = s.scan;
      const SumField sums = timed_call(state, [&] {
        window.join(std::move(filtered));
        return window.sums(scan);
      });
      return same_sums(sums, s);
    };
  });
  count_items(state, "voxels", mean_occupied(staged));
}

void otsu_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return dilate_occupied(s.scan,
                               above_threshold(s.scan, s.sums, threshold_of(s.scan, s.sums),
                                               s.carried, min_otsu_score),
                               pool);
      },
      [](const StagedScan& s, const VoxelSet& dynamic) {
        return dynamic.masks == s.dynamic.masks && threshold_of(s.scan, s.sums) == s.threshold;
      });
  count_items(state, "voxels", mean_occupied(staged));
}

/// Returns the region after the scans before `first`.
DynamicRegion region_after(const StagedScans& staged, std::size_t first) {
  DynamicRegion region = staged.new_region();
  for (std::size_t k = 0; k < first; ++k) {
    const StagedScan& s = staged.all[k];
    if (s.labels.empty()) continue;  // not judged yet
    region.update({s.scan, s.dynamic, s.from_region, s.beside, s.threshold}, s.k);
  }
  return region;
}

void dynamic_region_stage(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const int width = staged.workload.config.kernel_width_voxels;
  measure_with_memory(state, staged, [&](std::size_t first) {
    return [&, width, map = staged.map_after(first, pool),
            region = region_after(staged, first)](const StagedScan& s) mutable {
      staged.enter(map, s, pool);
      votes_for(s, map, width, pool);
      const StagedScan inputs = s;
      const VoxelSet from_region = timed_call(state, [&] {
        const VoxelSet beside = beside_unknown_of(inputs, region, map, width, pool);
        VoxelSet chosen = region.back_end(inputs.scan, beside, width, pool);
        region.update({inputs.scan, inputs.dynamic, chosen, beside, s.threshold}, s.k);
        return chosen;
      });
      return from_region.masks == s.from_region.masks;
    };
  });
  count_items(state, "voxels", mean_occupied(staged));
}

void labels_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const int min_otsu_score = staged.workload.config.min_otsu_score;
  measure_stage(
      state, staged,
      [&](const StagedScan& s) {
        return project_labels(s.scan, shows_motion(s.threshold, min_otsu_score)
                                          ? united(s.dynamic, s.from_region)
                                          : VoxelSet{});
      },
      [](const StagedScan& s, const std::vector<std::uint32_t>& labels) {
        return labels == s.labels;
      });
  count_items(state, "points", mean_points(staged));
}

/// A file that is deleted with its benchmark.
struct ScratchFile {
  explicit ScratchFile(const char* extension)
      : path(std::filesystem::temp_directory_path() /
             ("mosbench_bench_" + std::to_string(getpid()) + extension)) {}
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path path;
};

void read_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const std::vector<Point>& written = staged.last().frame.points;
  const ScratchFile file(".bin");
  write_bin(file.path, written);
  std::vector<Point> points;
  for (auto _ : state) points = read_bin(file.path);
  count_items(state, "points", points.size());
  expect(state, format_bin(points) == format_bin(written));
}

void write_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const ScratchFile file(".label");
  for (auto _ : state) write_labels(file.path, staged.last().labels);
  count_items(state, "points", staged.last().labels.size());
  expect(state, read_labels(file.path, staged.last().labels.size()) == staged.last().labels);
}

}  // namespace

std::vector<BenchmarkRow> stage_rows() {
  return {{"voxelize", voxelize_stage, true},
          {"raycast", raycast_stage, true},
          {"distance_field", distance_field_stage, false},
          {"hmm_update", hmm_stage, false},
          {"map_update", map_update_stage, true},
          {"evict", evict_stage, false},
          {"change_detection", change_detection_stage, false},
          {"convolution", convolution_stage, true},
          {"median", median_stage, true},
          {"window", window_stage, false},
          {"otsu", otsu_stage, false},
          {"dynamic_region", dynamic_region_stage, true},
          {"labels", labels_stage, false},
          {"read", read_stage, false},
          {"write", write_stage, false}};
}

}  // namespace mosbench
