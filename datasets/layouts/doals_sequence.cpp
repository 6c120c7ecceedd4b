#include "datasets/layouts/doals_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/scan_file.hpp"
#include "datasets/rosbag/bag_recording.hpp"
#include "datasets/sequence/recording.hpp"

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

std::unique_ptr<ScanSource> open_scans(const std::filesystem::path& folder,
                                       const ReadingOptions& options) {
  if (!scan_folder_of(folder)) {
    if (const auto bag = bag_of(folder)) return std::make_unique<BagRecording>(*bag, options);
  }
  return std::make_unique<Recording>(folder, options);
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
                             const DoalsPublished* published, const ReadingOptions& options)
    : SourcedSequence(std::move(name), open_scans(folder, options)),
      indices_file_(folder / "indices.csv") {
  open_truth(published);
}

void DoalsSequence::open_truth(const DoalsPublished* published) {
  if (!is_there(indices_file_)) {
    truth_remarks_.push_back("no indices.csv: there is no truth");
    return;
  }
  const auto rows = read_indices(indices_file_);
  const bool has_stamps = !source().stamps_ns().empty();
  const auto scans = has_stamps ? scans_by_stamp(rows) : scans_by_list(rows, published);
  if (!has_stamps) {
    truth_remarks_.push_back(
        fmt::format("no stamps: the rows of indices.csv belong to the labelled scans published for "
                    "DOALS sequence {}",
                    published->number));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    check_indices(rows[i], point_count(scans[i]), indices_file_);
    truth_.emplace(scans[i], rows[i]);
  }
}

std::vector<std::size_t> DoalsSequence::scans_by_stamp(std::span<const IndicesRow> rows) const {
  std::multimap<std::int64_t, std::size_t> scan_of_stamp;
  for (std::size_t i = 0; i < size(); ++i) scan_of_stamp.emplace(source().stamps_ns()[i], i);
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
  if (row == truth_.end()) {
    throw DataError(source().file(scan_index), "has no truth", "a labelled scan");
  }
  std::vector<std::uint32_t> labels(point_count(scan_index), kStaticLabel);
  for (const std::uint32_t index : row->second.moving) labels[index] = kMovingLabel;
  return labels;
}

std::vector<std::filesystem::path> DoalsSequence::files() const {
  std::vector<std::filesystem::path> files = source().files();
  if (is_there(indices_file_)) files.push_back(indices_file_);
  return files;
}

std::vector<std::string> DoalsSequence::remarks() const {
  std::vector<std::string> remarks = source().remarks();
  remarks.insert(remarks.end(), truth_remarks_.begin(), truth_remarks_.end());
  return remarks;
}

}  // namespace mosbench
