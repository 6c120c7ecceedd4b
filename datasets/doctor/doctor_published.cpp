#include <fmt/format.h>

#include "datasets/doctor/doctor.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {

std::vector<Symptom> check_published(const Sequence& sequence, DatasetKind kind,
                                     const std::filesystem::path& folder,
                                     SequenceCheckup& checkup) {
  std::vector<Symptom> symptoms;
  const auto expect = [&](std::size_t found, std::size_t published, const char* what) {
    if (found == published) return;
    symptoms.push_back(
        {Severity::kWarning, sequence.name(),
         fmt::format("has {} {}; expected {}, as published", found, what, published)});
  };
  for (const PublishedCount& count : layout_of(kind).files.published) {
    if (!ends_with(folder, count.folder)) continue;
    if (sequence.size() < count.scans) {
      checkup.remarks.push_back(
          fmt::format("has {} of the {} scans that are published", sequence.size(), count.scans));
    } else {
      expect(sequence.size(), count.scans, "scans");
    }
    if (count.points != 0)
      expect(sequence.point_count(0), count.points, "points in its first scan");
  }
  return symptoms;
}

}  // namespace mosbench
