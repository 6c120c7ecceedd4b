#include <fmt/format.h>

#include <array>

#include "datasets/doctor/doctor.hpp"
#include "datasets/layouts/catalogue.hpp"
#include "datasets/layouts/doals_sequence.hpp"

namespace mosbench {
namespace {

struct PublishedCount {
  DatasetKind kind;
  std::string_view sequence;
  std::size_t scans;
};

/// Rows of the pose files that the authors of HMM-MOS (HeLiMOS) and MotionBEV (SemanticKITTI)
/// publish, and MotionBEV's evaluator output (Sipailou).
constexpr std::array<PublishedCount, 27> kCounts = {{
    {DatasetKind::kHelimos, "Velodyne", 12477}, {DatasetKind::kHelimos, "Ouster", 12477},
    {DatasetKind::kHelimos, "Avia", 12476},     {DatasetKind::kHelimos, "Aeva", 12475},
    {DatasetKind::kSipailou, "06", 3191},       {DatasetKind::kSemanticKitti, "00", 4541},
    {DatasetKind::kSemanticKitti, "01", 1101},  {DatasetKind::kSemanticKitti, "02", 4661},
    {DatasetKind::kSemanticKitti, "03", 801},   {DatasetKind::kSemanticKitti, "04", 271},
    {DatasetKind::kSemanticKitti, "05", 2761},  {DatasetKind::kSemanticKitti, "06", 1101},
    {DatasetKind::kSemanticKitti, "07", 1101},  {DatasetKind::kSemanticKitti, "08", 4071},
    {DatasetKind::kSemanticKitti, "09", 1591},  {DatasetKind::kSemanticKitti, "10", 1201},
    {DatasetKind::kSemanticKitti, "11", 921},   {DatasetKind::kSemanticKitti, "12", 1061},
    {DatasetKind::kSemanticKitti, "13", 3281},  {DatasetKind::kSemanticKitti, "14", 631},
    {DatasetKind::kSemanticKitti, "15", 1901},  {DatasetKind::kSemanticKitti, "16", 1731},
    {DatasetKind::kSemanticKitti, "17", 491},   {DatasetKind::kSemanticKitti, "18", 1801},
    {DatasetKind::kSemanticKitti, "19", 4981},  {DatasetKind::kSemanticKitti, "20", 831},
    {DatasetKind::kSemanticKitti, "21", 2721},
}};

}  // namespace

std::vector<Symptom> check_published(const Sequence& sequence, DatasetKind kind,
                                     const std::filesystem::path& folder) {
  std::vector<Symptom> symptoms;
  const auto expect = [&](std::size_t found, std::size_t published, const char* what) {
    if (found == published) return;
    symptoms.push_back(
        {Severity::kWarning, sequence.name(),
         fmt::format("has {} {}; expected {}, as published", found, what, published)});
  };
  if (kind == DatasetKind::kDoals) {
    const DoalsPublished* published =
        find_doals_published(folder_name(parent_folder(folder)), folder_name(folder));
    if (published == nullptr) return symptoms;
    constexpr std::size_t kSlots = 131072;
    expect(sequence.size(), published->scans, "scans");
    expect(sequence.point_count(0), kSlots, "points in its first scan");
    return symptoms;
  }
  for (const PublishedCount& count : kCounts) {
    if (count.kind != kind || count.sequence != sequence.name()) continue;
    expect(sequence.size(), count.scans, "scans");
  }
  return symptoms;
}

}  // namespace mosbench
