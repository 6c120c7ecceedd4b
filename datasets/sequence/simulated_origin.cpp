#include "datasets/sequence/simulated_origin.hpp"

#include <nlohmann/json.hpp>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDisturbed = "disturbed: ";

/// Returns by what data were disturbed; nothing for a text that says nothing of it.
std::optional<std::string> disturbance_in(std::string_view text) {
  const std::string_view line = take_line(text);
  if (!line.starts_with(kDisturbed)) return std::nullopt;
  return std::string(line.substr(kDisturbed.size()));
}

}  // namespace

std::string format_simulated_origin(const SimulatedOrigin& origin) {
  Json marker = {{"simulated", true},     {"layout", origin.layout},
                 {"scene", origin.scene}, {"scene_fingerprint", origin.scene_fingerprint},
                 {"scans", origin.scans}, {"seed", origin.seed}};
  if (origin.perturb) marker["perturb"] = *origin.perturb;
  return marker.dump(2) + "\n";
}

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file) {
  try {
    const Json marker = parse_json(text, file);
    SimulatedOrigin origin{.layout = marker.at("layout").get<std::string>(),
                           .scene = marker.at("scene").get<std::string>(),
                           .scene_fingerprint = marker.at("scene_fingerprint").get<std::string>(),
                           .scans = marker.at("scans").get<std::size_t>(),
                           .seed = marker.at("seed").get<std::uint64_t>()};
    if (marker.contains("perturb")) origin.perturb = marker.at("perturb").get<std::string>();
    return origin;
  } catch (const Json::exception& error) {
    throw DataError(file, "cannot be understood (" + sentence_of(error) + ")",
                    "a marker written by mosbench");
  }
}

std::optional<SimulatedOrigin> simulated_origin(const std::filesystem::path& folder) {
  const std::filesystem::path marker = folder / kSimulatedMarker;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(marker, ignored)) return std::nullopt;
  return parse_simulated_origin(read_file(marker), marker);
}

DataMark mark_in(const std::filesystem::path& folder) {
  DataMark mark{simulated_origin(folder), ""};
  if (mark.simulated) mark.disturbed = mark.simulated->perturb.value_or("");
  const std::filesystem::path marker = folder / kDisturbedMarker;
  std::error_code ignored;
  const bool is_there = std::filesystem::is_regular_file(marker, ignored);
  if (!mark.disturbed.empty() || !is_there) return mark;
  // A file of this name that says nothing of it is the user's.
  mark.disturbed = disturbance_in(read_file(marker)).value_or("");
  return mark;
}

DataMark mark_of_file(const std::filesystem::path& file, int folders_above) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(file, error).parent_path();
  for (int above = 0; above <= folders_above && !error; ++above) {
    if (DataMark mark = mark_in(folder); mark.is_set()) return mark;
    folder = folder.parent_path();
  }
  return {};
}

DataMark disturbed_by(DataMark mark, const std::string& perturb) {
  if (perturb.empty()) return mark;
  mark.disturbed += (mark.disturbed.empty() ? "" : ", then ") + perturb;
  if (mark.simulated) mark.simulated->perturb = mark.disturbed;
  return mark;
}

DataMark merged(DataMark mark, const DataMark& other) {
  if (!mark.simulated) mark.simulated = other.simulated;
  if (mark.disturbed.find(other.disturbed) == std::string::npos) {
    mark.disturbed += (mark.disturbed.empty() ? "" : " and ") + other.disturbed;
  }
  if (mark.simulated && !mark.disturbed.empty()) mark.simulated->perturb = mark.disturbed;
  return mark;
}

std::string disturbed_doubt(const DataMark& mark) {
  return mark.disturbed.empty() ? "" : std::string(kDisturbedDoubt) + mark.disturbed;
}

std::string_view marker_name(const DataMark& mark) {
  return mark.simulated ? kSimulatedMarker : kDisturbedMarker;
}

std::string format_mark(const DataMark& mark) {
  if (mark.simulated) return format_simulated_origin(*mark.simulated);
  return std::string(kDisturbed) + mark.disturbed +
         "\nmosbench changed these scans, poses or stamps on purpose: no sensor measured them "
         "so.\n";
}

DataMark parse_mark(std::string_view text, const std::filesystem::path& file) {
  if (!text.starts_with('{')) {
    if (auto disturbed = disturbance_in(text)) return {std::nullopt, *std::move(disturbed)};
    throw DataError(file, "says nothing of disturbances", "a mark written by mosbench");
  }
  DataMark mark{parse_simulated_origin(text, file), ""};
  mark.disturbed = mark.simulated->perturb.value_or("");
  return mark;
}

}  // namespace mosbench
