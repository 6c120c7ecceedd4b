#include "eval/truth/decisions.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::size_t count_from(const ordered_json& json) {
  if (!json.is_number_unsigned()) throw std::invalid_argument("a count that is no whole number");
  return json.get<std::size_t>();
}

ordered_json json_of(const Decision& decision) {
  ordered_json json = {{"track", decision.track},
                       {"decided", kDecidedNames[static_cast<std::size_t>(decision.decided)]}};
  if (decision.decided != Decided::kMade) return json;
  json["takes"] = ordered_json::object();
  for (const auto& [track, points] : decision.edit.takes) {
    json["takes"][std::to_string(track)] = points;
  }
  json["scans"] = {decision.edit.first_scan, decision.edit.last_scan};
  json["corners_m"] = ordered_json::array();
  for (const Eigen::Vector2d& corner_m : decision.edit.corners_m) {
    json["corners_m"].push_back({corner_m.x(), corner_m.y()});
  }
  return json;
}

}  // namespace

TrackEdit edit_from(const ordered_json& json) {
  TrackEdit edit;
  const ordered_json& takes = json.at("takes");
  if (!takes.is_object()) throw std::invalid_argument("tracks that are no object");
  for (const auto& [track, points] : takes.items()) {
    const auto number = parse_unsigned(track);
    if (!number || *number > std::numeric_limits<std::uint32_t>::max()) {
      throw std::invalid_argument("a track that is no number");
    }
    edit.takes[static_cast<std::uint32_t>(*number)] = count_from(points);
  }
  const ordered_json& scans = json.at("scans");
  edit.first_scan = count_from(scans.at(0));
  edit.last_scan = count_from(scans.at(1));
  for (const ordered_json& corner : json.at("corners_m")) {
    edit.corners_m.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  }
  const std::size_t corners = edit.corners_m.size();
  const bool paints = edit.takes.contains(0);
  if (edit.last_scan < edit.first_scan) throw std::invalid_argument("scans that end too soon");
  if ((paints && corners == 0) || corners == 1 || corners == 2) {
    throw std::invalid_argument("a polygon of less than three corners");
  }
  return edit;
}

std::vector<Decision> parse_decisions(std::string_view text, const std::filesystem::path& file) {
  const ordered_json json = parse_json(text, file);
  const char* expected =
      "{\"format\": 1, \"decisions\": [{\"track\": \"08/12\", \"decided\": \"moving\"}, ...]}, or "
      "static, unsure or taken-back, or a track made as `mosbench truth review` writes it";
  std::vector<Decision> decisions;
  try {
    if (json.at("format") != 1) throw DataError(file, "has another \"format\"", expected);
    for (const ordered_json& member : json.at("decisions")) {
      const auto decided =
          std::ranges::find(kDecidedNames, member.at("decided").get<std::string>());
      if (decided == kDecidedNames.end()) {
        throw DataError(file, "has a decision that is not known", expected);
      }
      Decision& decision =
          decisions.emplace_back(member.at("track").get<std::string>(),
                                 static_cast<Decided>(decided - kDecidedNames.begin()));
      if (decision.decided == Decided::kMade) decision.edit = edit_from(member);
    }
  } catch (const ordered_json::exception& error) {
    throw DataError(file, sentence_of(error), expected);
  } catch (const std::invalid_argument& error) {
    throw DataError(file, std::string("has ") + error.what(), expected);
  }
  return decisions;
}

std::string format_decisions(std::span<const Decision> decisions) {
  ordered_json json = {{"format", 1}, {"decisions", ordered_json::array()}};
  for (const Decision& decision : decisions) json["decisions"].push_back(json_of(decision));
  return json_text(json);
}

std::map<std::string, Decided> last_of_each(std::span<const Decision> decisions) {
  std::map<std::string, Decided> last;
  for (const auto& [track, decided, edit] : decisions) {
    if (decided >= Decided::kTakenBack) {
      last.erase(track);
    } else {
      last[track] = decided;
    }
  }
  return last;
}

}  // namespace mosbench
