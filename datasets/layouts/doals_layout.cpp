#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/sequence/folder_sequence.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// One of the eight published sequences.
struct DoalsPublished {
  int number;
  std::string_view scene, sequence;  ///< folder of the scene, and that below it
  std::string_view split;            ///< column of the paper's table
  std::size_t scans;                 ///< length of the recording
};

constexpr std::array<DoalsPublished, 8> kPublished = {
    {{1, "hauptgebaeude", "sequence_1", "HG", 1079},
     {2, "hauptgebaeude", "sequence_2", "HG", 1488},
     {3, "niederdorf", "sequence_1", "ND", 1768},
     {4, "niederdorf", "sequence_2", "ND", 1668},
     {5, "shopville", "sequence_1", "SV", 1068},
     {6, "shopville", "sequence_2", "SV", 1988},
     {7, "station", "sequence_1", "ST", 2008},
     {8, "station", "sequence_2", "ST", 1758}}};

/// Their labelled scans, counted from 1, of evalIndFile.cpp of HMM-MOS.
constexpr std::size_t kLabelledScans[][10] = {
    {89, 199, 309, 419, 529, 639, 749, 859, 969, 1079},
    {129, 279, 429, 579, 729, 879, 1029, 1179, 1329, 1479},
    {76, 256, 436, 616, 796, 976, 1156, 1336, 1516, 1696},
    {139, 299, 459, 619, 779, 939, 1099, 1259, 1419, 1579},
    {79, 179, 279, 379, 479, 579, 679, 779, 879, 979},
    {199, 399, 527, 599, 799, 999, 1199, 1399, 1599, 1799},
    {37, 149, 349, 549, 749, 949, 1149, 1349, 1549, 1749},
    {149, 319, 489, 659, 829, 999, 1169, 1339, 1509, 1679}};

/// The published sequence that a folder is named as, or null.
const DoalsPublished* published_of(const std::filesystem::path& folder) {
  const auto found = std::ranges::find_if(kPublished, [&](const DoalsPublished& published) {
    return published.scene == folder_name(parent_folder(folder)) &&
           published.sequence == folder_name(folder);
  });
  return found == kPublished.end() ? nullptr : &*found;
}

std::unique_ptr<Sequence> open_scans(std::string name, const std::filesystem::path& folder,
                                     const Reading& asked) {
  if (is_bag_file(folder)) return std::make_unique<BagSequence>(std::move(name), folder, asked);
  if (!scan_folder_of(folder)) {
    if (const auto bag = bag_of(folder)) {
      return std::make_unique<BagSequence>(std::move(name), *bag, asked);
    }
  }
  return std::make_unique<FolderSequence>(std::move(name), folder, asked);
}

/// One DOALS sequence: its folder with the bag, or the bag, or scans exported to velodyne/ or
/// binFiles/ in the raw firing order with no point dropped and poses.txt; indices.csv with the
/// moving points of the labelled scans. With both, the exported scans are read. Truth is
/// kMovingLabel for listed points and kStaticLabel for all others. A labelled scan is identified by
/// its exact stamp; without stamps by the published list, if the recording has the published
/// length.
class DoalsSequence : public SequenceAround {
 public:
  /// `published` is null for a recording that is none of the published ones. Throws DataError, also
  /// for a stamp or an index in indices.csv that no scan has.
  DoalsSequence(std::string name, const std::filesystem::path& folder,
                const DoalsPublished* published, const Reading& asked)
      : SequenceAround(open_scans(std::move(name), folder, asked)),
        indices_file_((is_bag_file(folder) ? folder.parent_path() : folder) / "indices.csv") {
    open_truth(published);
  }

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
    SequenceAround::read(scan_index, frame);
    add_truth(scan_index, frame);
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    const auto row = truth_.find(scan_index);
    if (row == truth_.end()) refuse_truth(scan_index);
    std::vector<std::uint32_t> labels(point_count(scan_index), kStaticLabel);
    for (const std::uint32_t index : row->second.moving) labels[index] = kMovingLabel;
    return labels;
  }

 private:
  void open_truth(const DoalsPublished* published) {
    Recording& recording = mutable_recording();
    if (!is_there(indices_file_)) {
      recording.remarks.push_back("no indices.csv: there is no truth");
      return;
    }
    std::vector<IndicesRow> rows = read_indices(indices_file_);
    std::erase_if(rows, [&](const IndicesRow& row) {
      return std::ranges::find(recording.left_out, row.stamp_ns, &ScanEntry::stamp_ns) !=
             recording.left_out.end();
    });
    const bool has_stamps = scan(0).stamp_ns.has_value();
    const auto scans = has_stamps ? scans_by_stamp(rows) : scans_by_list(rows, published);
    if (!has_stamps) {
      recording.remarks.push_back(fmt::format(
          "no stamps: the rows of indices.csv belong to the labelled scans published for "
          "DOALS sequence {}",
          published->number));
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      check_indices(rows[i], point_count(scans[i]), indices_file_);
      truth_.emplace(scans[i], rows[i]);
      recording.scans[scans[i]].has_truth = true;
    }
    recording.truth_files = {indices_file_};
  }

  std::vector<std::size_t> scans_by_stamp(std::span<const IndicesRow> rows) const {
    std::multimap<std::int64_t, std::size_t> scan_of_stamp;
    for (std::size_t i = 0; i < size(); ++i) scan_of_stamp.emplace(*stamp_ns(i), i);
    std::vector<std::size_t> scans;
    for (const IndicesRow& row : rows) {
      const auto same = scan_of_stamp.count(row.stamp_ns);
      if (same != 1) {
        throw DataError(
            indices_file_, row.line, fmt::format("{} scans have the stamp {}", same, row.stamp_ns),
            "exactly one, equal to the nanosecond (times.txt with nine decimals, or scan "
            "names in ns)");
      }
      scans.push_back(scan_of_stamp.find(row.stamp_ns)->second);
    }
    return scans;
  }

  std::vector<std::size_t> scans_by_list(std::span<const IndicesRow> rows,
                                         const DoalsPublished* published) const {
    if (published == nullptr) {
      throw DataError(indices_file_, "its stamps cannot be matched, as the scans have none",
                      "times.txt, scan names in ns, or a folder named as published "
                      "(station/sequence_1)");
    }
    const std::span labelled = kLabelledScans[published->number - 1];
    if (size() != published->scans || rows.size() != labelled.size()) {
      throw DataError(
          indices_file_,
          fmt::format("{} rows for {} scans without stamps do not fit the published list",
                      rows.size(), size()),
          fmt::format("{} rows for {} scans (DOALS sequence {}), or times.txt", labelled.size(),
                      published->scans, published->number));
    }
    std::vector<std::size_t> scans;
    for (const std::size_t counted_from_1 : labelled) scans.push_back(counted_from_1 - 1);
    return scans;
  }

  std::filesystem::path indices_file_;
  std::map<std::size_t, IndicesRow> truth_;  ///< by scan
};

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
  return splits_of_sequences(
      {"ST", "SV", "HG", "ND"}, folders, [](std::string_view split, const SequenceFolder& folder) {
        const std::string scene = folder_name(parent_folder(folder.folder));
        const auto published = std::ranges::find(kPublished, scene, &DoalsPublished::scene);
        return published != kPublished.end() && published->split == split;
      });
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
  for (const DoalsPublished& published : kPublished) {
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
