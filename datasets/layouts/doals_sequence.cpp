#include "datasets/layouts/doals_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/open_bag.hpp"
#include "datasets/sequence/folder_sequence.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::array<DoalsPublished, 8> kPublished = {{
    {1,
     "hauptgebaeude",
     "sequence_1",
     "HG",
     1079,
     {89, 199, 309, 419, 529, 639, 749, 859, 969, 1079}},
    {2,
     "hauptgebaeude",
     "sequence_2",
     "HG",
     1488,
     {129, 279, 429, 579, 729, 879, 1029, 1179, 1329, 1479}},
    {3,
     "niederdorf",
     "sequence_1",
     "ND",
     1768,
     {76, 256, 436, 616, 796, 976, 1156, 1336, 1516, 1696}},
    {4,
     "niederdorf",
     "sequence_2",
     "ND",
     1668,
     {139, 299, 459, 619, 779, 939, 1099, 1259, 1419, 1579}},
    {5, "shopville", "sequence_1", "SV", 1068, {79, 179, 279, 379, 479, 579, 679, 779, 879, 979}},
    {6,
     "shopville",
     "sequence_2",
     "SV",
     1988,
     {199, 399, 527, 599, 799, 999, 1199, 1399, 1599, 1799}},
    {7, "station", "sequence_1", "ST", 2008, {37, 149, 349, 549, 749, 949, 1149, 1349, 1549, 1749}},
    {8,
     "station",
     "sequence_2",
     "ST",
     1758,
     {149, 319, 489, 659, 829, 999, 1169, 1339, 1509, 1679}},
}};

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

}  // namespace

std::span<const DoalsPublished> doals_published() { return kPublished; }

const DoalsPublished* find_doals_published(std::string_view scene, std::string_view sequence) {
  const auto found = std::ranges::find_if(kPublished, [&](const DoalsPublished& published) {
    return published.scene == scene && published.sequence == sequence;
  });
  return found == kPublished.end() ? nullptr : &*found;
}

DoalsSequence::DoalsSequence(std::string name, const std::filesystem::path& folder,
                             const DoalsPublished* published, const Reading& asked)
    : SequenceAround(open_scans(std::move(name), folder, asked)),
      indices_file_((is_bag_file(folder) ? folder.parent_path() : folder) / "indices.csv") {
  open_truth(published);
}

void DoalsSequence::open_truth(const DoalsPublished* published) {
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
    recording.remarks.push_back(
        fmt::format("no stamps: the rows of indices.csv belong to the labelled scans published for "
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

void DoalsSequence::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  add_truth(scan_index, frame);
}

std::vector<std::size_t> DoalsSequence::scans_by_stamp(std::span<const IndicesRow> rows) const {
  std::multimap<std::int64_t, std::size_t> scan_of_stamp;
  for (std::size_t i = 0; i < size(); ++i) scan_of_stamp.emplace(*stamp_ns(i), i);
  std::vector<std::size_t> scans;
  for (const IndicesRow& row : rows) {
    const auto same = scan_of_stamp.count(row.stamp_ns);
    if (same != 1) {
      throw DataError(indices_file_, row.line,
                      fmt::format("{} scans have the stamp {}", same, row.stamp_ns),
                      "exactly one, equal to the nanosecond (times.txt with nine decimals, or scan "
                      "names in ns)");
    }
    scans.push_back(scan_of_stamp.find(row.stamp_ns)->second);
  }
  return scans;
}

std::vector<std::size_t> DoalsSequence::scans_by_list(std::span<const IndicesRow> rows,
                                                      const DoalsPublished* published) const {
  if (published == nullptr) {
    throw DataError(indices_file_, "its stamps cannot be matched, as the scans have none",
                    "times.txt, scan names in ns, or a folder named as published "
                    "(station/sequence_1)");
  }
  if (size() != published->scans || rows.size() != published->truth.size()) {
    throw DataError(indices_file_,
                    fmt::format("{} rows for {} scans without stamps do not fit the published list",
                                rows.size(), size()),
                    fmt::format("{} rows for {} scans (DOALS sequence {}), or times.txt",
                                published->truth.size(), published->scans, published->number));
  }
  std::vector<std::size_t> scans;
  for (const std::size_t counted_from_1 : published->truth) scans.push_back(counted_from_1 - 1);
  return scans;
}

std::vector<std::uint32_t> DoalsSequence::read_truth(std::size_t scan_index) const {
  const auto row = truth_.find(scan_index);
  if (row == truth_.end()) refuse_truth(scan_index);
  std::vector<std::uint32_t> labels(point_count(scan_index), kStaticLabel);
  for (const std::uint32_t index : row->second.moving) labels[index] = kMovingLabel;
  return labels;
}

}  // namespace mosbench
