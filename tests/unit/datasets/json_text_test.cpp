#include "datasets/text/json_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "datasets/formats/nuscenes_table.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::Not;

template <typename Work>
std::string fault_of(Work&& work) {
  try {
    work();
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

std::string fault_of_json(const std::string& text) {
  return fault_of([&] { (void)parse_json(text, "file.json"); });
}

std::string object_of_keys(std::size_t count) {
  std::string text = "{";
  for (std::size_t i = 0; i < count; ++i) {
    text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  }
  return text + "}";
}

TEST(JsonText, IsRefusedWithANulAnywhere) {
  using namespace std::string_literals;
  for (const std::string& text : {"{}\0"s, "{}\0garbage"s, "\0{}"s, "{\"a\": \0 1}"s, "{}\n\0"s}) {
    EXPECT_THAT(fault_of_json(text), HasSubstr("file.json: is no JSON (byte ")) << text;
  }
  EXPECT_EQ(fault_of_json("{\"a\": \"\\u0000\"}\n"), "") << "as a letter of a string it is one";
}

TEST(JsonText, OfATableIsRefusedWithANulBehindIt) {
  using namespace std::string_literals;
  const auto fault = [](const std::string& text) {
    return fault_of([&] {
      std::istringstream bytes(text);
      parse_nuscenes_table(bytes, "table.json", [](const NuscenesRow&) {});
    });
  };
  EXPECT_EQ(fault("[]\n"), "");
  EXPECT_THAT(fault("[]\0"s), HasSubstr("table.json: is no JSON (it holds a NUL)"));
  EXPECT_THAT(fault("[]\0 [{}]"s), HasSubstr("table.json: is no JSON (it holds a NUL)"));
  EXPECT_EQ(fault("[" + object_of_keys(1000) + "]"), "");
  EXPECT_THAT(fault("[" + object_of_keys(1001) + "]"), HasSubstr("has more than 1000 keys"));
}

TEST(JsonText, HasALimitOfKeysPerObject) {
  EXPECT_EQ(fault_of_json(object_of_keys(2'000)), "");
  EXPECT_THAT(fault_of_json(object_of_keys(1'000'000)),
              HasSubstr("has more than 20000 keys in one object"));
}

TEST(JsonText, IsSpokenOfWithoutTheLibrarysNumbers) {
  EXPECT_THAT(fault_of_json("{"), Not(HasSubstr("json.exception")));
  try {
    (void)nlohmann::ordered_json::object().at("scans");
  } catch (const std::exception& error) {
    EXPECT_EQ(sentence_of(error), "lacks \"scans\"");
  }
  try {
    (void)nlohmann::ordered_json(1).get<std::string>();
  } catch (const std::exception& error) {
    EXPECT_EQ(sentence_of(error), "type must be string, but is number");
  }
}

TEST(FarPoses, AreRefused) {
  const std::string near = "1 0 0 5e6 0 1 0 5e6 0 0 1 0\n";
  const auto kitti = [&](const std::string& x) {
    return fault_of(
        [&] { (void)parse_poses(near + "1 0 0 " + x + " 0 1 0 5e6 0 0 1 0\n", "p.txt"); });
  };
  const auto tum = [](const std::string& x) {
    return fault_of([&] {
      (void)parse_pose_list("1 0 0 0 0 0 0 1\n2 " + x + " 0 0 0 0 0 1\n", std::nullopt, "p.txt");
    });
  };
  EXPECT_EQ(kitti("-4.9e6"), "");
  EXPECT_EQ(tum("1e7"), "");
  for (const char* x : {"1.6e7", "-1e8", "1e308", "-1.7e308"}) {
    EXPECT_THAT(kitti(x), HasSubstr("m from the first pose, expected at most 1e+07 m")) << x;
    EXPECT_THAT(tum(x), HasSubstr("p.txt:2: is ")) << x;
  }
}

}  // namespace
}  // namespace mosbench
