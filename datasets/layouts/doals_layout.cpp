#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/doals_sequence.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/rosbag/open_bag.hpp"

namespace mosbench {
namespace {

const DoalsPublished* published_of(const std::filesystem::path& folder) {
  return find_doals_published(folder_name(parent_folder(folder)), folder_name(folder));
}

SequenceFolder sequence_folder(std::string name, const std::filesystem::path& folder) {
  const DoalsPublished* published = published_of(folder);
  return {std::move(name), folder, published ? std::to_string(published->number) : ""};
}

bool is_sequence_name(const std::string& name) { return name.starts_with("sequence_"); }

/// Adds the sequence_N folders of one scene, with scans, a bag or neither; `prefix` goes before
/// their names.
void list_scene(const std::filesystem::path& scene, const std::string& prefix,
                std::vector<SequenceFolder>& sequences) {
  for (const auto& folder : list_folders(scene)) {
    const std::string name = folder.filename().string();
    if (!is_sequence_name(name)) continue;
    sequences.push_back(sequence_folder(prefix + name, folder));
  }
}

/// Lists in alphabetical order, which for the published scenes is that of the published numbers.
std::vector<SequenceFolder> list_doals(const std::filesystem::path& path) {
  if (is_bag_file(path)) return {{path.stem().string(), path, ""}};
  if (!std::filesystem::is_directory(path)) return {};
  if (scan_folder_of(path) || !list_by_stem(path, {".bag"}).empty())
    return {sequence_folder(folder_name(path), path)};
  std::vector<SequenceFolder> sequences;
  list_scene(path, "", sequences);
  if (!sequences.empty()) return sequences;
  for (const auto& scene : list_folders(path)) {
    list_scene(scene, scene.filename().string() + "/", sequences);
  }
  return sequences;
}

std::unique_ptr<Sequence> open_doals(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<DoalsSequence>(sequence.name, sequence.folder,
                                         published_of(sequence.folder), asked);
}

/// Returns ST, SV, HG and ND: both sequences of a scene.
std::vector<Split> doals_splits(const std::vector<SequenceFolder>& folders,
                                const std::vector<std::unique_ptr<Sequence>>&,
                                std::vector<std::string>&) {
  std::vector<Split> splits;
  for (const std::string_view name : {"ST", "SV", "HG", "ND"}) {
    Split split{std::string(name), {}};
    for (std::size_t i = 0; i < folders.size(); ++i) {
      const std::string scene = folder_name(parent_folder(folders[i].folder));
      const DoalsPublished* published = find_doals_published(scene, "sequence_1");
      if (published && published->split == name) split.parts.push_back({i, std::nullopt});
    }
    if (!split.parts.empty()) splits.push_back(std::move(split));
  }
  return splits;
}

/// Many a bag holds an Ouster's scans: only what lies around it tells that it is of this set.
std::optional<std::string> recognise_doals_bag(const std::filesystem::path& folder) {
  if (is_there(folder / "indices.csv")) return "indices.csv is beside the bag";
  if (is_sequence_name(folder_name(folder))) return "the bag is in a folder sequence_N";
  return std::nullopt;
}

std::optional<std::string> recognise_doals(const std::filesystem::path& path) {
  if (is_bag_file(path)) return recognise_doals_bag(parent_folder(path));
  const auto sequences = list_doals(path);
  for (const SequenceFolder& sequence : sequences) {
    if (is_there(sequence.folder / "indices.csv")) return "indices.csv is there";
  }
  if (sequences.empty()) return std::nullopt;
  if (is_sequence_name(folder_name(sequences.front().folder))) {
    return "sequence_N folders are there";
  }
  return std::nullopt;
}

/// Returns the name of a DOALS sequence unchanged; another name becomes a scene with a sequence_1.
std::filesystem::path doals_folder(const std::string& name, std::size_t) {
  if (is_sequence_name(std::filesystem::path(name).filename().string())) return name;
  return std::filesystem::path(flat_name(name)) / "sequence_1";
}

/// By appearance: moving are the points of what moves and of what looks as if it could.
std::uint32_t simulated_doals_label(const SimulatedReturn& seen) {
  const bool moves = seen.owner.moving || seen.owner.dynamic_by_appearance;
  return moves ? kMovingLabel : kStaticLabel;
}

/// The last scan included, from the fifth on.
std::set<std::size_t> ten_labelled(std::size_t scans) {
  constexpr std::size_t kFirst = 4, kLabelled = 10;
  std::set<std::size_t> labelled;
  for (std::size_t i = 1; i <= kLabelled; ++i) {
    const std::size_t end = i * scans / kLabelled;
    if (end > kFirst) labelled.insert(end - 1);
  }
  return labelled;
}

std::vector<PublishedCount> published_counts() {
  constexpr std::size_t kSlots = 131072;
  std::vector<PublishedCount> counts;
  for (const DoalsPublished& published : doals_published()) {
    counts.push_back({std::string(published.scene) + "/" + std::string(published.sequence),
                      published.scans, kSlots});
  }
  return counts;
}

}  // namespace

const Layout& doals_layout() {
  static const Layout row = {
      .name = "doals",
      .usual = {"doals-20m", "doals-hmm"},
      .title = "Urban Dynamic Objects LiDAR, ICRA 2021",
      .content = "hand-held Ouster OS1-64 in 4 places, 10 labelled scans in each of 8 sequences",
      .size = "12825 scans, 8 bags",
      .published = "DOI 10.3929/ethz-c-000788171",
      .licence = kUnknownLicence,
      .folders =
          {"<root>/{hauptgebaeude,niederdorf,shopville,station}/sequence_{1,2}/",
           "  *.bag                          as published: /os1_cloud_node/points and /tf",
           "  indices.csv                    stamp in ns, then the moving points of a labelled "
           "scan",
           "or instead of the bag",
           "  velodyne/*.bin (or binFiles/)  x y z intensity float32, all 131072 points in firing "
           "order",
           "  poses.txt                      12 numbers a row, lidar frame"},
      .files = {.label_ids = {kStaticLabel, kMovingLabel},
                .sensor_range_m = 150.0,
                .published = published_counts()},
      .expected =
          "<scene>/sequence_N with a bag, or velodyne/ or binFiles/ and poses.txt, and "
          "indices.csv each (DOALS), or one such sequence folder, or a bag",
      .list = list_doals,
      .open = open_doals,
      .no_point_times = recording_without_times,
      .splits = doals_splits,
      .evidence = Evidence::kFolders,
      .recognise = recognise_doals,
      .writer = LayoutWriter{.open = write_as_doals,
                             .folder = doals_folder,
                             .files = files_of_doals,
                             .keeps = KeptTruth::kMoving},
      .simulation = LayoutSimulation{
          .recordings = {{"{}/sequence_1", "{}/sequence_1", SensorKind::kOs1_64}},
          .truth =
              "Truth is by appearance as in DOALS: a person who stands still is listed as dynamic.",
          .label = simulated_doals_label,
          .labelled = ten_labelled,
          .keeps_lost = true}};
  return row;
}

}  // namespace mosbench
