#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/sensor_model.hpp"
#include "datasets/simulator/trajectory.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// What a scene file may hold for a field: the closed interval of a number (for a list, of each of
/// its numbers) and whether the key must be there.
struct FieldRule {
  double lowest = -1e5;
  double highest = 1e5;
  bool required = false;
};

constexpr FieldRule kPosition{.required = true};
constexpr FieldRule kDuration{.lowest = 0.0, .highest = 1e6};
constexpr FieldRule kSize{.lowest = 0.01, .highest = 1e4};
constexpr FieldRule kSpeed{.lowest = 0.01, .highest = 100.0, .required = true};
constexpr FieldRule kAngle{.lowest = -10.0, .highest = 10.0};
constexpr FieldRule kMust{.required = true};

template <typename T, typename Record>
concept Of = std::same_as<std::remove_const_t<T>, Record>;

// The one list of fields per record: visit_fields(record, visit) calls visit(key, member, rule) for
// each. Reading, writing and the unknown-key check of scene files all walk these.

void visit_fields(Of<Leg> auto& leg, auto&& visit) {
  visit("to_m", leg.to_m, kPosition);
  visit("speed_m_s", leg.speed_m_s, kSpeed);
  visit("wait_s", leg.wait_s, kDuration);
}

void visit_fields(Of<Route> auto& route, auto&& visit) {
  visit("from_m", route.from_m, kPosition);
  visit("legs", route.legs);
  visit("after", route.after);
  visit("start_s", route.start_s, kDuration);
}

void visit_fields(Of<Ego> auto& ego, auto&& visit) {
  visit("carrier", ego.carrier, kMust);
  visit("sensor_height_m", ego.sensor_height_m, FieldRule{.lowest = 0.1, .highest = 100.0});
  visit("route", ego.route, kMust);
}

void visit_fields(Of<GroundPlane> auto& plane, auto&& visit) {
  visit("height_m", plane.height_m);
  visit("slope_x", plane.slope_x, FieldRule{.lowest = -2.0, .highest = 2.0});
  visit("slope_y", plane.slope_y, FieldRule{.lowest = -2.0, .highest = 2.0});
}

void visit_fields(Of<Structure> auto& structure, auto&& visit) {
  visit("shape", structure.shape, kMust);
  visit("center_m", structure.center_m, kPosition);
  visit("size_m", structure.size_m, FieldRule{.lowest = 0.01, .highest = 1e4, .required = true});
  visit("yaw_rad", structure.yaw_rad, kAngle);
  visit("density", structure.density, FieldRule{.lowest = 0.01, .highest = 1.0});
  visit("sway_m", structure.sway_m, FieldRule{.lowest = 0.0, .highest = 2.0});
  visit("let_through", structure.let_through, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("mirrors", structure.mirrors);
  visit("labelled", structure.labelled);
}

void visit_fields(Of<Mover> auto& mover, auto&& visit) {
  visit("kind", mover.kind, kMust);
  visit("route", mover.route, kMust);
  visit("labelled", mover.labelled);
  visit("dynamic_by_appearance", mover.dynamic_by_appearance);
}

void visit_fields(Of<Door> auto& door, auto&& visit) {
  visit("hinge_m", door.hinge_m, kPosition);
  visit("width_m", door.width_m, kSize);
  visit("height_m", door.height_m, kSize);
  visit("closed_yaw_rad", door.closed_yaw_rad, kAngle);
  visit("open_yaw_rad", door.open_yaw_rad, kAngle);
  visit("swing_s", door.swing_s, FieldRule{.lowest = 0.05, .highest = 1e4});
  visit("period_s", door.period_s, FieldRule{.lowest = 0.1, .highest = 1e6});
  visit("start_s", door.start_s, kDuration);
  visit("labelled", door.labelled);
}

void visit_fields(Of<Ball> auto& ball, auto&& visit) {
  visit("from_m", ball.from_m, kPosition);
  visit("velocity_m_s", ball.velocity_m_s, FieldRule{.lowest = -100.0, .highest = 100.0});
  visit("radius_m", ball.radius_m, FieldRule{.lowest = 0.01, .highest = 10.0});
  visit("period_s", ball.period_s, FieldRule{.lowest = 0.1, .highest = 1e6});
  visit("start_s", ball.start_s, kDuration);
  visit("labelled", ball.labelled);
}

void visit_fields(Of<Scene> auto& scene, auto&& visit) {
  visit("name", scene.name, kMust);
  visit("scan_period_s", scene.scan_period_s, FieldRule{.lowest = 0.001, .highest = 10.0});
  visit("sensor", scene.sensor);
  visit("columns", scene.columns, FieldRule{.lowest = 16, .highest = 8192});
  visit("range_noise_m", scene.range_noise_m, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("dropout_probability", scene.dropout_probability, FieldRule{.lowest = 0.0, .highest = 1.0});
  visit("beam_width_rad", scene.beam_width_rad, FieldRule{.lowest = 0.0, .highest = 0.05});
  visit("ground_bumps_m", scene.ground_bumps_m, FieldRule{.lowest = 0.0, .highest = 0.5});
  visit("ego", scene.ego, kMust);
  visit("ground", scene.ground);
  visit("structures", scene.structures);
  visit("movers", scene.movers);
  visit("doors", scene.doors);
  visit("balls", scene.balls);
}

// The names that enumerators have in scene files, in their order.
constexpr std::array<std::string_view, 3> names_of(AfterRoute) {
  return {"stay", "return", "restart"};
}
constexpr std::array<std::string_view, 4> names_of(Carrier) {
  return {"tripod", "hand-held", "ground-robot", "car"};
}
constexpr std::array<std::string_view, 3> names_of(Shape) { return {"box", "cylinder", "sphere"}; }
constexpr std::array<std::string_view, 4> names_of(MoverKind) {
  return {"pedestrian", "cyclist", "car", "truck"};
}

// Ordered, so that a written scene reads in the order of its field lists.
using Json = nlohmann::ordered_json;

/// The place of a value: file and path in the JSON.
struct Place {
  const std::filesystem::path& file;
  std::string path;

  Place key(std::string_view name) const {
    return {file, path.empty() ? std::string(name) : fmt::format("{}.{}", path, name)};
  }
  Place element(std::size_t i) const { return {file, fmt::format("{}[{}]", path, i)}; }
  [[noreturn]] void refuse(std::string_view wrong, const std::string& expected) const {
    throw DataError(file, fmt::format("{}: {}", path.empty() ? "scene" : path, wrong), expected);
  }
};

std::string shown(const Json& value) {
  // Not printed whole: a list nested a million times would print itself by recursion.
  if (value.is_array()) return "a list";
  if (value.is_object()) return "an object";
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() <= 40 ? text : text.substr(0, 37) + "...";
}

template <typename Record>
void read(const Json& value, Record& record, const FieldRule& rule, const Place& place);

void read(const Json& value, bool& member, const FieldRule&, const Place& place) {
  if (!value.is_boolean()) place.refuse(shown(value) + " is no truth value", "true or false");
  member = value.get<bool>();
}

void read(const Json& value, std::string& member, const FieldRule&, const Place& place) {
  if (!value.is_string()) place.refuse(shown(value) + " is no text", "a string");
  member = value.get<std::string>();
}

void check_range(const Json& value, double number, const FieldRule& rule, const Place& place) {
  if (!(number >= rule.lowest && number <= rule.highest)) {
    place.refuse(shown(value) + " is out of range",
                 fmt::format("{} to {}", rule.lowest, rule.highest));
  }
}

void read(const Json& value, double& member, const FieldRule& rule, const Place& place) {
  if (!value.is_number()) place.refuse(shown(value) + " is no number", "a number");
  check_range(value, value.get<double>(), rule, place);
  member = value.get<double>();
}

void read(const Json& value, std::int64_t& member, const FieldRule& rule, const Place& place) {
  if (!value.is_number_integer()) place.refuse(shown(value) + " is no whole number", "an integer");
  check_range(value, value.get<double>(), rule, place);
  member = value.get<std::int64_t>();
}

void require_list(const Json& value, const Place& place) {
  if (!value.is_array()) place.refuse(shown(value) + " is no list", "a list [...]");
}

template <std::size_t kCount>
void read(const Json& value, std::array<double, kCount>& member, const FieldRule& rule,
          const Place& place) {
  require_list(value, place);
  if (value.size() != kCount) {
    place.refuse(fmt::format("has {} numbers", value.size()), fmt::format("{} numbers", kCount));
  }
  for (std::size_t i = 0; i < kCount; ++i) read(value[i], member[i], rule, place.element(i));
}

template <typename Element>
void read(const Json& value, std::vector<Element>& member, const FieldRule& rule,
          const Place& place) {
  require_list(value, place);
  member.clear();
  for (std::size_t i = 0; i < value.size(); ++i) {
    read(value[i], member.emplace_back(), rule, place.element(i));
  }
}

template <typename Optional>
void read(const Json& value, std::optional<Optional>& member, const FieldRule& rule,
          const Place& place) {
  read(value, member.emplace(), rule, place);
}

template <typename Enum>
requires std::is_enum_v<Enum>
void read(const Json& value, Enum& member, const FieldRule& rule, const Place& place) {
  std::string name;
  read(value, name, rule, place);
  constexpr auto known = names_of(Enum{});
  const auto found = std::ranges::find(known, name);
  if (found != known.end()) {
    member = static_cast<Enum>(found - known.begin());
    return;
  }
  place.refuse(
      shown(value) + " is unknown",
      fmt::format("one of {}, such as \"{}\"", fmt::join(known, ", "), nearest_name(name, known)));
}

void check_record(const auto&, const Place&) {}

void check_record(const Route& route, const Place& place) {
  if (route.after != AfterRoute::kStay && !(route_duration_s(route) > 0.0)) {
    place.refuse("its legs take no time", "legs to walk, or \"after\": \"stay\"");
  }
}

void check_record(const Ego& ego, const Place& place) {
  const Route& route = ego.route;
  if (route.after == AfterRoute::kRestart && route.legs.back().to_m != route.from_m) {
    place.key("route").refuse("the carrier would jump from the last leg's end to the start",
                              "a last leg that ends at from_m");
  }
}

void check_record(const Structure& structure, const Place& place) {
  const auto& size_m = structure.size_m;
  const bool round = structure.shape == Shape::kBox || size_m[0] == size_m[1];
  const bool ball = structure.shape != Shape::kSphere || size_m[0] == size_m[2];
  if (!round || !ball) {
    place.key("size_m").refuse("is not round", "equal extents for a cylinder (x, y) or a sphere");
  }
  if (structure.sway_m && structure.density >= 1.0) {
    place.key("sway_m").refuse("is of no vegetation", "a \"density\" below 1");
  }
  if (structure.mirrors.value_or(false) && structure.shape != Shape::kBox) {
    place.key("mirrors").refuse("is of no box", "\"shape\": \"box\"");
  }
}

void check_record(const Door& door, const Place& place) {
  if (2.0 * door.swing_s > door.period_s) {
    place.key("period_s").refuse("is shorter than opening and closing", "at least 2 * swing_s");
  }
}

void check_record(const Scene& scene, const Place& place) {
  if (scene.name.empty() || scene.name.size() > 64 ||
      scene.name.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
          std::string::npos) {
    place.key("name").refuse("cannot name a folder", "1 to 64 letters, digits, - or _");
  }
  if (scene.sensor && !sensor_kind_from_string(*scene.sensor)) {
    place.key("sensor").refuse(fmt::format("\"{}\" is unknown", *scene.sensor),
                               fmt::format("one of {}", fmt::join(sensor_names(), ", ")));
  }
}

void check_keys(const Json& value, const auto& record, const Place& place) {
  std::vector<std::string_view> known;
  visit_fields(record, [&](std::string_view key, const auto&, const FieldRule& = {}) {
    known.push_back(key);
  });
  for (const auto& [key, ignored] : value.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      place.refuse(fmt::format("unknown key {}", shown(Json(key))),
                   fmt::format("a known key such as \"{}\"", nearest_name(key, known)));
    }
  }
}

template <typename Record>
void read(const Json& value, Record& record, const FieldRule&, const Place& place) {
  if (!value.is_object()) place.refuse(shown(value) + " is no record", "an object {...}");
  check_keys(value, record, place);
  visit_fields(record, [&](std::string_view key, auto& member, const FieldRule& rule = {}) {
    const auto found = value.find(std::string(key));
    if (found != value.end()) {
      read(*found, member, rule, place.key(key));
    } else if (rule.required) {
      place.refuse(fmt::format("has no \"{}\"", key), "this key");
    }
  });
  check_record(record, place);
}

Json to_json(const auto& value) { return value; }

Json to_json(const auto& value) requires std::is_enum_v<std::remove_cvref_t<decltype(value)>> {
  return std::string(names_of(value)[static_cast<std::size_t>(value)]);
}

template <typename Record>
concept HasFields = requires(const Record& record) {
  visit_fields(record, [](std::string_view, const auto&, const FieldRule& = {}) {});
};

template <HasFields Record>
Json to_json(const Record& record);

template <typename Element>
Json to_json(const std::vector<Element>& elements) {
  Json list = Json::array();
  for (const Element& element : elements) list.push_back(to_json(element));
  return list;
}

template <typename Value>
Json to_json(const std::optional<Value>& value) {
  return value ? to_json(*value) : Json();
}

template <HasFields Record>
Json to_json(const Record& record) {
  Json object = Json::object();
  visit_fields(record, [&](std::string_view key, const auto& member, const FieldRule& = {}) {
    Json value = to_json(member);
    if (!value.is_null()) object[std::string(key)] = std::move(value);
  });
  return object;
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& file) {
  Scene scene;
  read(parse_json(text, file), scene, FieldRule{}, Place{file, ""});
  return scene;
}

std::string format_scene(const Scene& scene) { return to_json(scene).dump(2) + "\n"; }

Scene read_scene(const std::filesystem::path& file) { return parse_scene(read_file(file), file); }

}  // namespace mosbench
