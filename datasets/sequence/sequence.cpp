#include "datasets/sequence/sequence.hpp"

#include <fmt/format.h>

#include "datasets/text/errors.hpp"

namespace mosbench {

void Sequence::describe(std::size_t scan_index, Frame& frame) const {
  const ScanEntry& entry = scan(scan_index);
  frame.stem = entry.stem;
  frame.map_from_sensor = entry.map_from_sensor;
  frame.stamp_ns = entry.stamp_ns;
  frame.point_times_ns.clear();
  frame.motions.reset();
  frame.radial_velocity_m_s.clear();
}

std::vector<std::uint32_t> Sequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  return *read(scan_index).truth;
}

void Sequence::add_truth(std::size_t scan_index, Frame& frame) const {
  frame.truth.reset();
  if (has_truth(scan_index)) frame.truth = read_truth(scan_index);
}

void Sequence::refuse_truth(std::size_t scan_index) const {
  const std::filesystem::path place = std::filesystem::path(name()) / stem(scan_index);
  throw DataError(scan_file(scan_index).value_or(place), "has no truth", "a labelled scan");
}

void Sequence::check_count(std::size_t scan_index, std::size_t points) const {
  const ScanEntry& entry = scan(scan_index);
  if (points == entry.points) return;
  throw DataError(*entry.file, "changed since the sequence was opened",
                  fmt::format("{} points", entry.points));
}

std::vector<std::size_t> scans_with_truth(const Sequence& sequence) {
  std::vector<std::size_t> scans;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (sequence.has_truth(k)) scans.push_back(k);
  }
  return scans;
}

}  // namespace mosbench
