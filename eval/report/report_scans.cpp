#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/report/point_planes.hpp"
#include "eval/report/report.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

using Sources = std::vector<std::optional<ResultScans>>;

/// What the labels of one result say of a scan; empty what the run did not keep.
struct Planes {
  std::string outcomes, scores, reasons;
};

struct PackedScan {
  std::size_t scan_index;
  ordered_json header;
  std::string positions;
  std::string velocities;       ///< empty where the sensor measures none
  std::vector<Planes> members;  ///< of the cloud

  std::size_t bytes() const {
    std::size_t sum = positions.size() + velocities.size();
    for (const Planes& member : members) {
      sum += member.outcomes.size() + member.scores.size() + member.reasons.size();
    }
    return sum;
  }
};

struct Cloud {
  std::vector<std::size_t> members;  ///< positions in the results
  std::vector<std::size_t> wanted;
  std::size_t tried = 0;  ///< of wanted
  std::vector<PackedScan> packed;
  bool full = false;
};

/// Merges lists round robin: the first of each list, then the second of each, ...
std::vector<std::size_t> merged_round_robin(
    const std::vector<std::vector<std::size_t>>& wanted_lists) {
  std::vector<std::size_t> merged;
  const auto most = std::ranges::max(wanted_lists, {}, &std::vector<std::size_t>::size).size();
  for (std::size_t i = 0; i < most; ++i) {
    for (const std::vector<std::size_t>& of_result : wanted_lists) {
      if (i >= of_result.size() || std::ranges::count(merged, of_result[i]) > 0) continue;
      merged.push_back(of_result[i]);
    }
  }
  return merged;
}

/// Says in which way the points were read; poses do not change them unless they undistort.
std::map<std::string, std::string> reading_of_points(const ResultScans& scans) {
  const ReadingMembers members = members_of(scans.sequence().reading());
  std::map<std::string, std::string> reading(members.begin(), members.end());
  if (reading.contains("deskew")) return reading;
  std::erase_if(reading, [](const auto& entry) { return entry.first.starts_with("pose"); });
  return reading;
}

bool have_same_truth(const ScanRow& one, const ScanRow& other) {
  return !one.truth_hash || !other.truth_hash || one.truth_hash == other.truth_hash;
}

/// Whether a result of `mosbench score`, which has no fingerprint, is of the same files.
bool are_of_same_files(const ResultScans& one, const ResultScans& other) {
  namespace fs = std::filesystem;
  return fs::canonical(one.dataset().root) == fs::canonical(other.dataset().root) &&
         reading_of_points(one) == reading_of_points(other) &&
         std::ranges::equal(one.rows(), other.rows(), have_same_truth) &&
         std::ranges::equal(one.rows(), other.rows(), {}, &ScanRow::stem, &ScanRow::stem);
}

bool are_of_same_frames(const ResultScans& one, const ResultScans& other) {
  if (one.result().sequence != other.result().sequence) return false;
  const std::string& fingerprint = one.result().from.fingerprint;
  const std::string& another = other.result().from.fingerprint;
  const bool is_known = !fingerprint.empty() && !another.empty();
  return is_known ? fingerprint == another : are_of_same_files(one, other);
}

/// Positions of the results with points: first those whose frames have a fingerprint.
std::vector<std::size_t> order_of_grouping(const Sources& sources) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i]) order.push_back(i);
  }
  std::ranges::stable_partition(
      order, [&](std::size_t i) { return !sources[i]->result().from.fingerprint.empty(); });
  return order;
}

std::vector<Cloud> group_by_frames(const Sources& sources, const ScanChoice& choice) {
  std::vector<Cloud> clouds;
  for (const std::size_t i : order_of_grouping(sources)) {
    const auto same = std::ranges::find_if(clouds, [&](const Cloud& cloud) {
      return are_of_same_frames(*sources[cloud.members.front()], *sources[i]);
    });
    Cloud& cloud = same == clouds.end() ? clouds.emplace_back() : *same;
    cloud.members.push_back(i);
  }
  for (Cloud& cloud : clouds) {
    std::vector<std::vector<std::size_t>> wanted_lists;
    for (const std::size_t i : cloud.members) {
      std::vector<std::size_t>& wanted =
          wanted_lists.emplace_back(choice.wanted(sources[i]->rows()));
      std::erase_if(wanted, [&](std::size_t k) { return !sources[i]->has(k); });
    }
    cloud.wanted = merged_round_robin(wanted_lists);
  }
  return clouds;
}

ordered_json pose_json(const Pose& pose) {
  ordered_json numbers = ordered_json::array();
  for (const auto& row : pose.matrix().topRows<3>().rowwise()) {
    for (const double number : row) numbers.push_back(number);
  }
  return numbers;
}

PackedScan pack(const Cloud& cloud, const Sources& sources, std::size_t scan_index) {
  PackedScan packed{scan_index, {}, {}, {}, {}};
  for (const std::size_t member : cloud.members) {
    const JudgedScan scan = sources[member]->read(scan_index);
    if (packed.positions.empty()) {
      packed.header = {{"index", scan_index},
                       {"stem", scan.frame.stem},
                       {"points", scan.frame.points.size()},
                       {"map_from_sensor", pose_json(scan.frame.map_from_sensor)}};
      packed.positions = compressed_text(position_planes(scan.frame.points));
      if (!scan.frame.radial_velocity_m_s.empty()) {
        packed.velocities = compressed_text(velocity_planes(scan.frame.radial_velocity_m_s));
      }
    }
    const ResultScans& source = *sources[member];
    packed.members.push_back(
        {compressed_text(outcome_plane(scan.outcomes, scan.frame.points)),
         source.has_scores() ? compressed_text(score_planes(scan.scores)) : "",
         source.has_reasons() ? compressed_text(format_reasons(scan.reasons)) : ""});
  }
  return packed;
}

void pack_until_full(std::vector<Cloud>& clouds, const Sources& sources, std::size_t max_bytes) {
  std::size_t wanted = 0, bytes = 0;
  for (const Cloud& cloud : clouds) wanted += cloud.wanted.size();
  Progress progress("report", wanted);
  for (bool any = true; any;) {
    any = false;
    for (Cloud& cloud : clouds) {
      if (cloud.full || cloud.tried == cloud.wanted.size()) continue;
      PackedScan scan = pack(cloud, sources, cloud.wanted[cloud.tried++]);
      cloud.full = bytes + scan.bytes() > max_bytes;
      if (cloud.full) continue;
      any = true;
      bytes += scan.bytes();
      cloud.packed.push_back(std::move(scan));
      progress.advance();
    }
  }
}

std::string left_out(const Cloud& cloud, std::size_t scans) {
  const std::size_t shown = cloud.packed.size();
  if (shown == scans) return "";
  std::string text =
      fmt::format("the points of {} of {} are in the file", shown, counted(scans, "scan"));
  if (cloud.wanted.size() < scans) text += fmt::format("; --scans chose {}", cloud.wanted.size());
  if (cloud.full) text += "; the others would take it above --max-mb";
  return text;
}

void check_packed(const std::vector<Cloud>& clouds) {
  const auto has_room = [](const Cloud& cloud) { return !cloud.full || !cloud.packed.empty(); };
  if (std::ranges::any_of(clouds, has_room)) return;
  throw UsageError("--max-mb: has no room for a single scan, expected more, or --scans none");
}

}  // namespace

void check_choice(const std::vector<Result>& results, const ScanChoice& choice) {
  std::size_t longest = 0;
  for (const Result& result : results) {
    if (!choice.wanted(result.scans).empty()) return;
    longest = std::max(longest, result.scans.size());
  }
  if (longest == 0) return;
  throw UsageError(
      fmt::format("--scans: chooses no scan, expected some of 0 to {}; 0-9 are the first ten, "
                  "worst:10 the ten worst",
                  longest - 1));
}

ReportScans choose_report_scans(const std::vector<Result>& results, const Sources& sources,
                                const ScanChoice& choice, std::size_t max_bytes) {
  ReportScans report;
  report.results.resize(results.size());
  std::vector<Cloud> clouds = group_by_frames(sources, choice);
  pack_until_full(clouds, sources, max_bytes);
  check_packed(clouds);
  for (Cloud& cloud : clouds) {
    std::ranges::sort(cloud.packed, {}, &PackedScan::scan_index);
    const Result& first = results[cloud.members.front()];
    const std::size_t scans = sources[cloud.members.front()]->rows().size();
    const std::string remark = left_out(cloud, scans);
    if (!remark.empty()) report.remarks.push_back(first.sequence.text() + ": " + remark);
    ordered_json json = {{"sequence", first.sequence.text()},
                         {"scans_in_sequence", scans},
                         {"left_out", remark},
                         {"scans", ordered_json::array()}};
    for (const std::size_t i : cloud.members) report.results[i].cloud = report.clouds.size();
    for (PackedScan& scan : cloud.packed) {
      // Returns the number of the block.
      const auto add = [&](std::string& text) {
        report.blocks.push_back(std::move(text));
        return report.blocks.size() - 1;
      };
      scan.header["positions"] = add(scan.positions);
      if (!scan.velocities.empty()) scan.header["radial_velocities"] = add(scan.velocities);
      json["scans"].push_back(std::move(scan.header));
      for (std::size_t m = 0; m < cloud.members.size(); ++m) {
        ReportScans::OfResult& result = report.results[cloud.members[m]];
        Planes& planes = scan.members[m];
        result.scans.push_back(scan.scan_index);
        result.outcome_blocks.push_back(add(planes.outcomes));
        if (!planes.scores.empty()) result.score_blocks.push_back(add(planes.scores));
        if (!planes.reasons.empty()) result.reason_blocks.push_back(add(planes.reasons));
      }
    }
    report.clouds.push_back(std::move(json));
  }
  return report;
}

}  // namespace mosbench
