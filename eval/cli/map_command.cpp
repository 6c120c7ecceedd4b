#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/result/output.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/static_map/floor_plan.hpp"
#include "eval/static_map/static_map.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

struct MapFlags : JobWords {
  RunPlace place;
  std::vector<std::string> files;
  double voxel_m = 0.1;
  std::string heights = "0.2,2";
};

/// Throws UsageError for a file of a kind that no map is.
void check_files(const std::vector<std::string>& files) {
  constexpr std::array<std::string_view, 4> kEndings = {".pcd", ".ply", ".pgm", ".yaml"};
  for (const fs::path file : files) {
    if (std::ranges::find(kEndings, file.extension().string()) == kEndings.end()) {
      throw UsageError(
          fmt::format("-o {}: is no map by its name, expected .pcd or .ply for points, .pgm or "
                      ".yaml for a floor "
                      "plan",
                      file.string()));
    }
    check_output(file);
  }
}

HeightRange heights_of(const std::string& text) {
  const auto words = split_at_commas(text);
  const auto low = words.size() == 2 ? parse_double(words[0]) : std::nullopt;
  const auto high = words.size() == 2 ? parse_double(words[1]) : std::nullopt;
  if (!low || !high || !(*low >= 0.0) || !(*low < *high)) {
    throw UsageError(fmt::format(
        "--height {}: is no range, expected MIN,MAX in metres above the ground, such as 0.2,2",
        text));
  }
  return {*low, *high};
}

/// Ranges in which the method judged points; others are labelled static, whatever they are.
RangeGate judged_range(const Result& result) {
  const RecordedSettings settings = result.settings.value_or(RecordedSettings());
  return {settings.number(common_settings::kMinRange_m, 0.0),
          settings.number(common_settings::kMaxRange_m, -1.0)};
}

bool is_plan(const fs::path& file) {
  return file.extension() == ".pgm" || file.extension() == ".yaml";
}

void write_map(const StaticMap& map, const fs::path& file) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  write_by(file, [&] {
    PartialFile partial(file);
    const ByteSink sink = [&](std::string_view bytes) { partial.write(bytes); };
    if (file.extension() == ".ply") {
      format_ply(map, sink);
    } else {
      format_pcd(map, file, sink);
    }
    partial.sync();
    partial.put_in_place_of(file);
  });
}

Sheet map_sheet(const StaticMap& map, const SequenceOutcome& run) {
  Sheet sheet{.columns = {{"sequence", Unit::kText},
                          {"scans"},
                          {"points"},
                          {"moving"},
                          {"in the map"},
                          {"static kept", Unit::kPercent, 2},
                          {"moving removed", Unit::kPercent, 2}}};
  const auto [points, moving] = moving_points(run.result);
  const MapCounts truth = map.voxels_with_truth();
  sheet.rows = {{run.result.sequence.text(), std::uint64_t{run.result.scans.size()}, points, moving,
                 map.size(), or_missing(truth.static_accuracy()),
                 or_missing(truth.dynamic_accuracy())}};
  sheet.notes = {fmt::format("a point per {:g} m, of what is {} from the sensor",
                             map.config().voxel_m, gate_text(map.config().range))};
  if (truth.static_points + truth.dynamic_points > 0) {
    sheet.notes.push_back(
        fmt::format("by the truth, {} of {} voxels that moving points alone hit are left as ghosts",
                    truth.dynamic_points - truth.removed_dynamic, truth.dynamic_points));
  }
  for (const std::string& remark : run.result.remarks) sheet.notes.push_back(remark);
  return sheet;
}

Answer map_answer(MapFlags flags) {
  check_files(flags.files);
  const HeightRange heights = heights_of(flags.heights);
  if (!flags.method && !flags.preset) flags.preset = "offline";
  const RunPlan plan = plan_run(job_of(flags), flags.place);
  if (plan.sequences.size() != 1) {
    throw UsageError(fmt::format("{} holds {}, expected one: --sequences NAME",
                                 flags.input.string(), counted(plan.sequences.size(), "sequence")));
  }
  SequenceOutcome run = execute_run(plan).front();
  run.result.file = run.folder / "result.json";
  const ResultScans scans(run.result, plan.dataset.root);
  const RangeGate range = judged_range(run.result);
  StaticMap map({.voxel_m = flags.voxel_m, .range = range, .by_majority = true},
                fs::path(flags.files.front() + ".tiles.partial"));
  FreeCells free(flags.voxel_m, heights);
  const bool has_plan = std::ranges::any_of(flags.files, is_plan);
  for_each_judged(scans, [&](const JudgedScan& scan) {
    map.add(scan);
    if (has_plan) free.add(scan, range);
  });
  Sheet sheet = map_sheet(map, run);
  std::optional<FloorPlan> plan_of_floor;
  for (const fs::path file : flags.files) {
    if (!is_plan(file)) {
      write_map(map, file);
      sheet.notes.push_back(fmt::format("map in {}", file.string()));
      continue;
    }
    const fs::path image = fs::path(file).replace_extension(".pgm");
    if (!plan_of_floor) plan_of_floor = floor_plan(map, free, heights, image);
    write_output(image, plan_of_floor->pgm);
    write_output(fs::path(file).replace_extension(".yaml"), plan_of_floor->yaml);
    sheet.notes.push_back(fmt::format("floor plan in {} and .yaml: {} occupied cells, {} free ones",
                                      image.string(), plan_of_floor->occupied,
                                      plan_of_floor->free));
  }
  sheet.notes.push_back(fmt::format("labels in {}", plan.out.string()));
  return {.standing = standing_of(ResultSet{plan.out, {run.result}}), .sheets = {sheet}};
}

}  // namespace

CommandRun add_map(CLI::App& command) {
  auto flags = std::make_shared<MapFlags>();
  add_method_flags(command, *flags, flags->place.threads);
  add_list(command, "-o FILE,...", flags->files,
           "Map to write: .pcd or .ply of points, .pgm with .yaml of the floor plan for map_server")
      ->required();
  add(command, "--voxel", flags->voxel_m, "Edge of a voxel of the map, which holds one point, m")
      ->check(number_in(0.01, 10.0))
      ->capture_default_str();
  add(command, "--height MIN,MAX", flags->heights,
      "Of the floor plan: heights above the ground of what is in the way, m")
      ->capture_default_str();
  add(command, "--out DIR", flags->place.out, "Folder of the labels (default: as of run)");
  command.add_flag("--overwrite", flags->place.overwrite, "Run again and replace what is in --out");
  add_odometry_flag(command, flags->odometry, "Find the poses by it instead of reading them");
  return [flags] { return map_answer(*flags); };
}

}  // namespace mosbench
