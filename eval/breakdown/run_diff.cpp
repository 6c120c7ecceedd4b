#include "eval/breakdown/run_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/layouts/folder_search.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::uint64_t apart(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : b - a; }

long long change(std::uint64_t from, std::uint64_t to) {
  return static_cast<long long>(to) - static_cast<long long>(from);
}

std::string scans_text(const RunNames& names, const std::vector<ScanDisagreement>& scans,
                       std::size_t at_most) {
  TextTable table({{"scan", TextTable::kLeft},
                   {names.first + " IoU %"},
                   {names.second + " IoU %"},
                   {"TP"},
                   {"FP"},
                   {"FN"}});
  for (std::size_t i = 0; i < std::min(at_most, scans.size()); ++i) {
    const PairedRuns::Scan& scan = scans[i].scan;
    const Confusion& first = *scan.first->counts;
    const Confusion& second = *scan.second->counts;
    table.add_row({scan.sequence + '/' + scan.stem, percent_text(moving_iou(first)),
                   percent_text(moving_iou(second)),
                   fmt::format("{:+}", change(first.tp, second.tp)),
                   fmt::format("{:+}", change(first.fp, second.fp)),
                   fmt::format("{:+}", change(first.fn, second.fn))});
  }
  return table.str();
}

std::string objects_text(const RunNames& names, const std::vector<ObjectDisagreement>& objects,
                         std::size_t at_most) {
  TextTable table({{"object", TextTable::kLeft},
                   {"points"},
                   {names.first + " found"},
                   {names.second + " found"},
                   {"range m"},
                   {"position in the map m"}});
  for (std::size_t i = 0; i < std::min(at_most, objects.size()); ++i) {
    const ObjectDisagreement& object = objects[i];
    table.add_row({fmt::format("{} {} to {}", object.sequence, object.first_scan, object.last_scan),
                   fmt::format("{}", object.points), fmt::format("{}", object.first_found),
                   fmt::format("{}", object.second_found),
                   fmt::format("{:.1f}", object.mean_range_m),
                   position_text(object.position_map_m)});
  }
  return table.str();
}

}  // namespace

RunNames names_apart(const std::filesystem::path& first, const std::filesystem::path& second) {
  RunNames names{folder_name(first), folder_name(second)};
  if (names.first == names.second) return {first.string(), second.string()};
  return names;
}

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

std::string diff_text(const RunNames& names, const PairedRuns& paired,
                      const std::vector<ObjectDisagreement>& objects, std::size_t at_most) {
  const std::vector<ScanDisagreement> scans = disagreeing_scans(paired);
  std::string text =
      fmt::format("{} of {} paired scans differ\n", scans.size(), paired.scans.size());
  if (!paired.unlike.empty()) text += "unlike: " + unlike_text(paired.unlike) + '\n';
  if (!scans.empty()) text += '\n' + scans_text(names, scans, at_most);
  if (!objects.empty()) {
    text += fmt::format("\n{} moving objects have different numbers of found points\n\n",
                        objects.size()) +
            objects_text(names, objects, at_most);
  }
  return text;
}

}  // namespace mosbench
