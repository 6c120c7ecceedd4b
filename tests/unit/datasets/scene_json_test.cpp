#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "tests/example_scene.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kSmallest =
    R"({"name": "s", "ego": {"carrier": "car", "route": {"from_m": [0, 0]}}})";

std::string error_of(const std::string& text) {
  return message_of<DataError>([&] { parse_scene(text, "s.json"); });
}

std::string smallest_with(const std::string& extra) {
  std::string text(kSmallest);
  return text.insert(text.size() - 1, ", " + extra);
}

TEST(SceneJson, NeedsLittleAndKeepsDefaults) {
  const Scene scene = parse_scene(kSmallest, "s.json");
  EXPECT_EQ(scene.name, "s");
  EXPECT_EQ(scene.ego.carrier, Carrier::kCar);
  EXPECT_EQ(scene.scan_period_s, 0.1);
  EXPECT_FALSE(scene.sensor);
}

TEST(SceneJson, ShowsEveryKindOfRecordInItsExample) {
  const Scene scene = parse_scene(example_scene_json(), "example.json");
  EXPECT_FALSE(scene.ground.empty());
  EXPECT_EQ(scene.structures.size(), 4U);
  EXPECT_EQ(scene.movers.size(), 3U);
  EXPECT_FALSE(scene.doors.empty());
  EXPECT_FALSE(scene.balls.empty());
  const Frame frame = Simulator(scene, sensor_model(SensorKind::kOs1_64), 1).frame(10);
  EXPECT_GT(std::count(frame.truth->begin(), frame.truth->end(), kMovingLabel), 500);
}

TEST(SceneJson, TakesTheKeysOfTheSensorFromTheScene) {
  const Scene scene = parse_scene(
      smallest_with(
          R"("sensor": "vlp-16", "columns": 100, "range_noise_m": 0, "dropout_probability": 0.5)"),
      "s.json");
  const Simulator simulator(scene, sensor_model(SensorKind::kVlp16), 1);
  EXPECT_EQ(simulator.sensor().slots(), 1600U);
  EXPECT_EQ(simulator.sensor().range_noise_m, 0.0);
  EXPECT_EQ(simulator.sensor().dropout_probability, 0.5);
}

TEST(SceneJson, NamesTheNearestKeyForAnUnknownOne) {
  EXPECT_EQ(error_of(smallest_with(R"("mover": [])")),
            "s.json: scene: unknown key \"mover\", expected a known key such as \"movers\"");
  EXPECT_EQ(error_of(smallest_with(
                R"("movers": [{"kind": "car", "route": {"from_m": [0, 0], "leg": []}}])")),
            "s.json: movers[0].route: unknown key \"leg\", expected a known key such as \"legs\"");
}

TEST(SceneJson, RefusesAMissingKey) {
  EXPECT_THAT(error_of(R"({"name": "s"})"), HasSubstr("s.json: scene: has no \"ego\""));
  EXPECT_THAT(error_of(smallest_with(R"("balls": [{"radius_m": 0.1}])")),
              HasSubstr("balls[0]: has no \"from_m\""));
}

TEST(SceneJson, RefusesWrongTypes) {
  EXPECT_THAT(error_of("[]"), StartsWith("s.json: scene: a list is no record"));
  EXPECT_THAT(error_of(smallest_with(R"("ground": 3)")), HasSubstr("ground: 3 is no list"));
  EXPECT_THAT(error_of(smallest_with(R"("columns": 64.5)")),
              HasSubstr("columns: 64.5 is no whole number"));
  EXPECT_THAT(error_of(smallest_with(R"("ground": [{"height_m": "0"}])")),
              HasSubstr("ground[0].height_m: \"0\" is no number"));
  EXPECT_THAT(error_of(smallest_with(R"("sensor": null)")), HasSubstr("sensor: null is no text"));
  EXPECT_THAT(error_of(smallest_with(R"("doors": [{"hinge_m": [1, 2, 3]}])")),
              HasSubstr("doors[0].hinge_m: has 3 numbers, expected 2 numbers"));
  EXPECT_THAT(error_of(smallest_with(R"("doors": [{"hinge_m": [1, 2], "labelled": 1}])")),
              HasSubstr("doors[0].labelled: 1 is no truth value"));
}

TEST(SceneJson, RefusesValuesOutOfRange) {
  EXPECT_THAT(error_of(smallest_with(R"("scan_period_s": 0)")),
              HasSubstr("scan_period_s: 0 is out of range, expected 0.001 to 10"));
  EXPECT_THAT(error_of(smallest_with(R"("columns": 1e9)")), HasSubstr("columns: "));
  EXPECT_THAT(error_of(smallest_with(R"("dropout_probability": -0.1)")),
              HasSubstr("dropout_probability: -0.1 is out of range"));
  EXPECT_THAT(
      error_of(smallest_with(
          R"("structures": [{"shape": "box", "center_m": [0, 0, 1e300], "size_m": [1, 1, 1]}])")),
      HasSubstr("structures[0].center_m[2]: "));
}

TEST(SceneJson, RefusesUnknownNames) {
  EXPECT_THAT(error_of(smallest_with(R"("sensor": "os1")")),
              HasSubstr("sensor: \"os1\" is unknown"));
  EXPECT_THAT(
      error_of(smallest_with(R"("movers": [{"kind": "cra", "route": {"from_m": [0, 0]}}])")),
      HasSubstr("movers[0].kind: \"cra\" is unknown, expected one of pedestrian, cyclist, "
                "car, truck, such as \"car\""));
  EXPECT_THAT(
      error_of(R"({"name": "../s", "ego": {"carrier": "car", "route": {"from_m": [0, 0]}}})"),
      HasSubstr("name: cannot name a folder"));
}

TEST(SceneJson, RefusesWhatCannotBeWalkedSwungOrBuilt) {
  EXPECT_THAT(
      error_of(smallest_with(
          R"("movers": [{"kind": "car", "route": {"from_m": [0, 0], "after": "return"}}])")),
      HasSubstr("movers[0].route: its legs take no time"));
  EXPECT_THAT(error_of(R"({"name": "s", "ego": {"carrier": "car", "route": {"from_m": [0, 0],
                  "after": "restart", "legs": [{"to_m": [9, 0], "speed_m_s": 1}]}}})"),
              HasSubstr("ego.route: the carrier would jump"));
  EXPECT_THAT(error_of(smallest_with(R"("doors": [{"hinge_m": [1, 2], "swing_s": 4}])")),
              HasSubstr("doors[0].period_s: is shorter"));
  EXPECT_THAT(
      error_of(smallest_with(
          R"("structures": [{"shape": "cylinder", "center_m": [0, 0, 1], "size_m": [1, 2, 1]}])")),
      HasSubstr("structures[0].size_m: is not round"));
  EXPECT_THAT(
      error_of(smallest_with(
          R"("structures": [{"shape": "box", "center_m": [0, 0, 1], "size_m": [1, 2, 1], "sway_m": 0.1}])")),
      HasSubstr("structures[0].sway_m: is of no vegetation"));
  EXPECT_THAT(
      error_of(smallest_with(
          R"("structures": [{"shape": "sphere", "center_m": [0, 0, 1], "size_m": [1, 1, 1], "mirrors": true}])")),
      HasSubstr("structures[0].mirrors: is of no box"));
}

TEST(SceneJson, RefusesTextThatIsNoJsonAndRepeatedKeys) {
  EXPECT_THAT(error_of("{"), StartsWith("s.json: is no JSON ("));
  EXPECT_THAT(error_of(""), StartsWith("s.json: is no JSON ("));
  EXPECT_THAT(error_of(R"({"name": "a", "name": "b"})"),
              HasSubstr("key \"name\" is there twice in one object"));
}

TEST(SceneJson, NamesAFileThatIsNotThere) {
  EXPECT_THAT(message_of<DataError>([] { read_scene("no-such-scene.json"); }),
              StartsWith("no-such-scene.json: "));
}

}  // namespace
}  // namespace mosbench
