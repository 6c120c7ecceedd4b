#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/hdf5/scene_flow_sequence.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// An empty or damaged file is known by its name, and opening it says what is wrong.
bool is_scene_flow_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return is_hdf5_file(path) ||
         (path.extension() == ".h5" && std::filesystem::is_regular_file(path, ignored));
}

std::vector<SequenceFolder> list_scene_flow(const std::filesystem::path& path) {
  if (is_scene_flow_file(path)) return {{path.stem().string(), path, ""}};
  std::vector<SequenceFolder> sequences;
  if (!std::filesystem::is_directory(path)) return sequences;
  for (const StemFile& file : list_by_stem(path, {".h5"})) {
    if (is_scene_flow_file(file.file)) sequences.push_back({file.stem, file.file, ""});
  }
  return sequences;
}

std::unique_ptr<Sequence> open_scene_flow(const SequenceFolder& sequence, const Reading& asked) {
  return open_scene_flow_file(sequence.name, sequence.folder, asked);
}

/// The scans that Argoverse 2's benchmark evaluates have a mask of its own.
std::vector<Split> scene_flow_splits(const std::vector<SequenceFolder>& files,
                                     const std::vector<std::unique_ptr<Sequence>>& sequences,
                                     std::vector<std::string>&) {
  Split evaluated{"eval", {}};
  for (std::size_t i = 0; i < files.size(); ++i) {
    SplitPart part{i, std::set<std::string>{}};
    const auto scans = evaluated_scans(files[i].folder);
    for (std::size_t k = 0; k < sequences[i]->size(); ++k) {
      const std::string& stem = sequences[i]->stem(k);
      if (std::ranges::binary_search(scans, stem)) part.stems->insert(stem);
    }
    if (!part.stems->empty()) evaluated.parts.push_back(std::move(part));
  }
  if (evaluated.parts.empty()) return {};
  return {std::move(evaluated)};
}

std::optional<std::string> recognise_scene_flow(const std::filesystem::path& path) {
  const auto files = list_scene_flow(path);
  if (files.empty()) return std::nullopt;
  if (is_scene_flow_file(path)) return "it is an .h5 file";
  const bool any_whole = std::ranges::any_of(
      files, [](const SequenceFolder& file) { return is_hdf5_file(file.folder); });
  if (!any_whole) return std::nullopt;
  return fmt::format("{} .h5 files are there", files.size());
}

std::optional<std::string> recognise_damaged_scene_flow(const std::filesystem::path& path) {
  const auto files = list_scene_flow(path);
  if (files.empty()) return std::nullopt;
  return fmt::format("{}, none of them whole",
                     counted(files.size(), ".h5 file is there", ".h5 files are there"));
}

std::filesystem::path scene_flow_file(const std::string& name, std::size_t) {
  return flat_name(name) + ".h5";
}

/// The owner of movable things is their instance, an int16 there.
std::uint32_t simulated_scene_flow_label(const SimulatedReturn& seen) {
  constexpr std::uint32_t kInstances = 32768;
  const std::uint32_t label = moving_label(seen);
  if (label == 0 || !is_movable(seen.owner)) return label;
  return with_instance(label, seen.owner_number, kInstances);
}

}  // namespace

const Layout& opensceneflow_layout() {
  static const Layout row = {
      .name = "opensceneflow",
      .usual = {"opensceneflow", "sceneflow-dynamic"},
      .title = "OpenSceneFlow's .h5: Argoverse 2, Waymo, nuScenes, ZOD, TruckScenes",
      .content = "scenes of about 20 s with scene flow; ZOD and the test splits without",
      .size = "Argoverse 2 sensor: 700 + 150 + 150 scenes; Waymo: 799 + 203",
      .published = "made by the dataprocess scripts of github.com/KTH-RPL/OpenSceneFlow",
      .licence = kUnknownLicence,
      .folders = {"<root>/<scene>.h5, a group per scan, named by its stamp in ns or us:",
                  "  lidar (N, 3 or more), pose (4, 4) map_from_sensor, and where there are any",
                  "  ground_mask, flow (N, 3) to the next scan, flow_is_valid, ego_motion,",
                  "  flow_category_indices, flow_instance_id, eval_mask, dufo"},
      .files = {.sensor_range_m = 450.0},
      .expected = "an .h5 file of OpenSceneFlow, or a folder with such files",
      .list = list_scene_flow,
      .open = open_scene_flow,
      .no_point_times =
          [](const std::filesystem::path& file) {
            return file.string() +
                   " holds points that are moved to the stamp already, expected .bin files";
          },
      .splits = scene_flow_splits,
      .evidence = Evidence::kFolders,
      .recognise = recognise_scene_flow,
      .recognise_part = recognise_damaged_scene_flow,
      .writer = LayoutWriter{
          .open = write_as_scene_flow,
          .folder = scene_flow_file,
          .files = [](const Sequence&) { return std::vector<std::filesystem::path>(); },
          .last_file = [](const WriteOptions&) { return ""; }},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{
          .recordings = {{"{}.h5", "{}", SensorKind::kHdl64e}},
          .truth = "Truth is the flow of rigid bodies from each scan to the next one.",
          .label = simulated_scene_flow_label,
          .has_flow = true}};
  return row;
}

}  // namespace mosbench
