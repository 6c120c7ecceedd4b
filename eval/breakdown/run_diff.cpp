#include "eval/breakdown/run_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/layouts/folder_search.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::uint64_t apart(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : b - a; }

long long change(std::uint64_t from, std::uint64_t to) {
  return static_cast<long long>(to) - static_cast<long long>(from);
}

/// Short names of two runs.
struct RunNames {
  std::string first, second;
};

/// Returns the last components of both paths, or the whole paths where those are equal.
RunNames names_apart(const std::filesystem::path& first, const std::filesystem::path& second) {
  RunNames names{folder_name(first), folder_name(second)};
  if (names.first == names.second) return {first.string(), second.string()};
  return names;
}

/// A scan in which two runs count differently.
struct ScanDisagreement {
  PairedRuns::Scan scan;
  std::uint64_t changed_points = 0;  ///< change of tp plus change of fp: a lower bound
};

/// Returns the scans whose counts differ, most changed first.
std::vector<ScanDisagreement> disagreeing_scans(const PairedRuns& paired) {
  std::vector<ScanDisagreement> scans;
  for (const PairedRuns::Scan& scan : paired.scans) {
    const Confusion& first = *scan.first->counts;
    const Confusion& second = *scan.second->counts;
    const std::uint64_t changed = apart(first.tp, second.tp) + apart(first.fp, second.fp);
    if (changed > 0) scans.push_back({scan, changed});
  }
  std::ranges::stable_sort(scans, std::ranges::greater{}, &ScanDisagreement::changed_points);
  return scans;
}

Sheet scans_sheet(const RunNames& names, const std::vector<ScanDisagreement>& scans,
                  std::size_t at_most) {
  Sheet sheet{.columns = {{"scan", Unit::kText},
                          {names.first + " IoU", Unit::kPercent},
                          {names.second + " IoU", Unit::kPercent},
                          {"TP", Unit::kChange},
                          {"FP", Unit::kChange},
                          {"FN", Unit::kChange}}};
  for (std::size_t i = 0; i < std::min(at_most, scans.size()); ++i) {
    const PairedRuns::Scan& scan = scans[i].scan;
    const Confusion& first = *scan.first->counts;
    const Confusion& second = *scan.second->counts;
    sheet.rows.push_back({scan.sequence + '/' + scan.stem, or_undefined(moving_iou(first)),
                          or_undefined(moving_iou(second)),
                          static_cast<double>(change(first.tp, second.tp)),
                          static_cast<double>(change(first.fp, second.fp)),
                          static_cast<double>(change(first.fn, second.fn))});
  }
  return sheet;
}

Sheet objects_sheet(const RunNames& names, const std::vector<ObjectDisagreement>& objects,
                    std::size_t at_most) {
  Sheet sheet{.lead = {fmt::format("{} moving objects have different numbers of found points",
                                   objects.size())},
              .columns = {{"object", Unit::kText},
                          {"points"},
                          {names.first + " found"},
                          {names.second + " found"},
                          {"range m", Unit::kNumber, 1},
                          {"position in the map m"}}};
  for (std::size_t i = 0; i < std::min(at_most, objects.size()); ++i) {
    const ObjectDisagreement& object = objects[i];
    sheet.rows.push_back(
        {fmt::format("{} {} to {}", object.sequence, object.first_scan, object.last_scan),
         std::uint64_t{object.points}, std::uint64_t{object.first_found},
         std::uint64_t{object.second_found}, object.mean_range_m,
         position_text(object.position_map_m)});
  }
  return sheet;
}

}  // namespace

std::vector<ObjectDisagreement> disagreeing_objects(const SequenceBreakdown& first,
                                                    const SequenceBreakdown& second) {
  if (first.objects.size() != second.objects.size()) {
    throw std::invalid_argument("disagreeing_objects: the truth differs");
  }
  std::vector<ObjectDisagreement> objects;
  for (std::size_t i = 0; i < first.objects.size(); ++i) {
    const ObjectTrack& object = first.objects[i];
    if (object.found() == second.objects[i].found()) continue;
    objects.push_back({first.sequence, first.stems[object.sightings.front().scan_index],
                       first.stems[object.sightings.back().scan_index], object.points(),
                       object.found(), second.objects[i].found(), object.mean_range_m(),
                       object.sightings.front().cluster.centre_map_m});
  }
  std::ranges::stable_sort(objects, std::ranges::greater{}, [](const ObjectDisagreement& object) {
    return apart(object.first_found, object.second_found);
  });
  return objects;
}

ordered_json diff_json(const PairedRuns& paired, const std::vector<ObjectDisagreement>& objects,
                       std::size_t at_most) {
  const std::vector<ScanDisagreement> scans = disagreeing_scans(paired);
  ordered_json json = {
      {"paired_scans", paired.scans.size()}, {"unlike", unlike_text(paired.unlike)},
      {"disagreeing_scans", scans.size()},   {"disagreeing_objects", objects.size()},
      {"scans", ordered_json::array()},      {"objects", ordered_json::array()}};
  for (std::size_t i = 0; i < std::min(at_most, scans.size()); ++i) {
    const PairedRuns::Scan& scan = scans[i].scan;
    const Confusion& first = *scan.first->counts;
    const Confusion& second = *scan.second->counts;
    json["scans"].push_back({{"sequence", scan.sequence},
                             {"scan", scan.stem},
                             {"first_iou", json_or_null(moving_iou(first))},
                             {"second_iou", json_or_null(moving_iou(second))},
                             {"tp_change", change(first.tp, second.tp)},
                             {"fp_change", change(first.fp, second.fp)},
                             {"fn_change", change(first.fn, second.fn)}});
  }
  for (std::size_t i = 0; i < std::min(at_most, objects.size()); ++i) {
    const ObjectDisagreement& object = objects[i];
    const Eigen::Vector3d& position = object.position_map_m;
    json["objects"].push_back({{"sequence", object.sequence},
                               {"first_scan", object.first_scan},
                               {"last_scan", object.last_scan},
                               {"points", object.points},
                               {"first_tp", object.first_found},
                               {"second_tp", object.second_found},
                               {"mean_range_m", object.mean_range_m},
                               {"position_map_m", {position.x(), position.y(), position.z()}}});
  }
  return json;
}

std::vector<Sheet> diff_sheets(const std::filesystem::path& first,
                               const std::filesystem::path& second, const PairedRuns& paired,
                               const std::vector<ObjectDisagreement>& objects,
                               std::size_t at_most) {
  const RunNames names = names_apart(first, second);
  const std::vector<ScanDisagreement> scans = disagreeing_scans(paired);
  Sheet sheet = scans.empty() ? Sheet{} : scans_sheet(names, scans, at_most);
  sheet.lead = {fmt::format("{} of {} paired scans differ", scans.size(), paired.scans.size())};
  if (!paired.unlike.empty()) sheet.lead.push_back("unlike: " + unlike_text(paired.unlike));
  std::vector<Sheet> sheets = {std::move(sheet)};
  if (!objects.empty()) sheets.push_back(objects_sheet(names, objects, at_most));
  return sheets;
}

}  // namespace mosbench
