#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "tests/example_scene.hpp"

namespace mosbench {
namespace {

// A scene that parses must also be castable into finite points; all else must be a DataError.
bool try_scene(const std::string& text) {
  Scene scene;
  try {
    scene = parse_scene(text, "fuzz.json");
  } catch (const DataError&) {
    return false;
  }
  scene.columns = 32;
  const Simulator simulator(scene, sensor_model(SensorKind::kVlp16), 1);
  for (const std::size_t scan_index : {0U, 7U, 900U}) {
    for (const Point& p : simulator.scan(scan_index).points) {
      EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << text;
    }
  }
  return true;
}

std::string mutated(std::string text, std::mt19937_64& random) {
  const std::vector<std::string> pieces = {
      "0", "-1", "1e308", "1e-308", "null", "[]",     "{}",      "\"\"", "true", ",",
      ":", "[",  "}",     "\xff",   "9",    "100000", "-100000", "0.01", "\\",   "e"};
  const std::size_t mutations = 1 + random() % 3;
  for (std::size_t i = 0; i < mutations; ++i) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text.erase(at, 1 + random() % 8);
        break;
      case 1:
        text.insert(at, pieces[random() % pieces.size()]);
        break;
      case 2:
        text[at] = static_cast<char>(random() % 256);
        break;
      default:
        // Replaces a whole number, which keeps the text JSON and reaches the range checks.
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = text.find_first_not_of("0123456789.", digit);
        text.replace(digit, end - digit, pieces[random() % pieces.size()]);
    }
    if (text.empty()) text.push_back('0');
  }
  return text;
}

TEST(SceneJsonFuzz, EndsInAnErrorOrInFinitePointsForMutatedScenes) {
  std::mt19937_64 random(20240601);
  const std::string example = example_scene_json();
  std::size_t accepted = 0, refused = 0;
  for (int i = 0; i < 3000; ++i) ++(try_scene(mutated(example, random)) ? accepted : refused);
  EXPECT_GT(accepted, 100U);
  EXPECT_GT(refused, 1000U);
}

TEST(SceneJsonFuzz, RefusesTheCorpusOfOddTexts) {
  const std::vector<std::string> corpus = {
      "",
      "null",
      "\xef\xbb\xbf{}",
      std::string(100000, '['),
      std::string(100000, '[') + std::string(100000, ']'),
      "{\"ego\": " + std::string(100000, '[') + std::string(100000, ']') + "}",
      R"({"name": "\u0000", "ego": {}})",
      R"({"name": 1e999})",
      R"({"name": "a", "ego": {"carrier": "car", "route": {"from_m": [1e999, 0]}}})",
      R"({"name": "a", "columns": 99999999999999999999, "ego": {}})",
      std::string("{\"name\": \"a\0b\"}", 15),
  };
  for (const std::string& text : corpus) EXPECT_FALSE(try_scene(text)) << text.substr(0, 60);
}

}  // namespace
}  // namespace mosbench
