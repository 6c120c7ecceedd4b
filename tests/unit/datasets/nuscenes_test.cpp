#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/nuscenes_table.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/nuscenes_tables.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/sequence_names.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

std::string table_error(const std::string& text) {
  return message_of<DataError>([&] {
    std::istringstream bytes(text);
    parse_nuscenes_table(bytes, "t.json", [](const NuscenesRow& row) {
      row.text("token");
      row.integer("timestamp");
      row.numbers("size", 3);
      row.texts("names");
      row.flag("is");
    });
  });
}

TEST(NuscenesTable, GivesRowsOfTextsNumbersAndLists) {
  std::istringstream bytes(
      R"([{"token": "a", "timestamp": 1532402927647951, "size": [1, 2.5, -3e2], "names": ["x", "y"],
           "is": true, "other": null, "deep": {"token": [{"b": 1}]}},
          {"names": [], "token": "b", "is": false, "size": [], "timestamp": -1}])");
  std::size_t rows = 0;
  parse_nuscenes_table(bytes, "t.json", [&](const NuscenesRow& row) {
    EXPECT_EQ(row.text("token"), rows == 0 ? "a" : "b");
    EXPECT_EQ(row.integer("timestamp"), rows == 0 ? 1532402927647951 : -1);
    EXPECT_EQ(row.flag("is"), rows == 0);
    if (rows == 0) {
      EXPECT_THAT(row.numbers("size", 3), ElementsAre(1.0, 2.5, -300.0));
    }
    EXPECT_EQ(row.texts("names").size(), rows == 0 ? 2U : 0U);
    ++rows;
  });
  EXPECT_EQ(rows, 2U);
}

TEST(NuscenesTable, RefusesWhatIsNoTable) {
  const std::string good =
      R"({"token": "a", "timestamp": 1, "size": [1, 2, 3], "names": ["x"], "is": true})";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string row = good;
    return table_error("[" + good + "," + row.replace(row.find(from), from.size(), to) + "]");
  };
  ASSERT_NO_THROW(with("1, 2, 3", "3, 2, 1.5"));
  EXPECT_THAT(with("\"token\": \"a\", ", ""), HasSubstr("t.json:1: has no \"token\""));
  EXPECT_THAT(with("\"a\"", "7"), HasSubstr("\"token\" is of another kind, expected a text"));
  EXPECT_THAT(with(": 1,", ": 1.5,"), HasSubstr("expected a whole number"));
  EXPECT_THAT(with("3]", "[3]]"), HasSubstr("expected a list of 3 finite numbers"));
  EXPECT_THAT(with(", 3]", "]"), HasSubstr("expected a list of 3 finite numbers"));
  EXPECT_THAT(with("3]", "null]"), HasSubstr("expected a list of 3 finite numbers"));
  EXPECT_THAT(with("[\"x\"]", "[1]"), HasSubstr("expected a list of texts"));
  EXPECT_THAT(with("\"is\"", "\"token\""), HasSubstr("key \"token\" is there twice"));
  EXPECT_THAT(table_error("[" + good), AllOf(HasSubstr("t.json: is no JSON"), HasSubstr("line 1")));
  for (const std::string text : {"", "{}", "7", "[7]", "[[]]", "[{}] {}", "\"t\""}) {
    EXPECT_THAT(table_error(text), HasSubstr("t.json:")) << text;
  }
}

constexpr const char* kNoTurn = R"("rotation": [1, 0, 0, 0])";

/// Two scenes; the first has a key frame, in which one box moves and one stands, and a sweep.
class NuscenesFolder : public testing::Test {
 protected:
  NuscenesFolder() {
    table("sensor",
          R"({"token": "cam", "channel": "CAM_FRONT"}, {"token": "top", "channel": "LIDAR_TOP"})");
    table("calibrated_sensor",
          fmt::format(R"({{"token": "c", "sensor_token": "cam", "translation": [9, 9, 9], {0}}},
                         {{"token": "l", "sensor_token": "top", "translation": [1, 0, 2],
                           "rotation": [0.7071067811865476, 0, 0, -0.7071067811865476]}})",
                      kNoTurn));
    table("scene",
          R"({"token": "s1", "name": "scene-0061"}, {"token": "s2", "name": "scene-0103"})");
    table("sample",
          R"({"token": "k1", "scene_token": "s1"}, {"token": "k2", "scene_token": "s2"})");
    table("sample_data", scan("d2", "k1", "sweeps/LIDAR_TOP/b.pcd.bin", 1050000, false) + "," +
                             scan("d1", "k1", "samples/LIDAR_TOP/a.pcd.bin", 1000000, true) + "," +
                             scan("d3", "k2", "samples/LIDAR_TOP/c.pcd.bin", 2000000, true) +
                             R"(,{"token": "p", "calibrated_sensor_token": "c"})");
    table("ego_pose", pose("d1", "100, 20, 0") + "," + pose("d2", "101, 20, 0") + "," +
                          pose("d3", "0, 0, 0") + "," + pose("p", "5, 5, 5"));
    table("attribute",
          R"({"token": "m", "name": "vehicle.moving"}, {"token": "w", "name": "cycle.with_rider"},
                          {"token": "v", "name": "pedestrian.moving"}, {"token": "q", "name": "vehicle.parked"})");
    table("sample_annotation", box("[101, 15, 2]", "[2, 4, 1]", "\"m\"") + "," +
                                   box("[101, 25, 2]", "[2, 4, 1]", "\"q\"") + "," +
                                   box("[101, 20, 7]", "[1, 1, 1]", ""));
    // In the map: by the mount x is map -y, y is map x, and the sensor stands at 101, 20, 2.
    const std::vector<Point> points = {{5, 0, 0, 1},        // the middle of the box that moves
                                       {5.9F, 1.9F, 0, 2},  // width is 2 along map y: in it
                                       {6.1F, 1.9F, 0, 3},  // beyond its width
                                       {5.0F, 2.1F, 0, 4},  // beyond its length
                                       {-5, 0, 0, 5},       // the one that is parked
                                       {5, 0, 0.6F, 6}};    // above it
    ByteSink sink;
    for (const Point& point : points) {
      sink.put(point);
      sink.put(31.0F);
    }
    const std::string bytes = std::move(sink).bytes();
    for (const char* file : {"samples/LIDAR_TOP/a", "sweeps/LIDAR_TOP/b", "samples/LIDAR_TOP/c"}) {
      folder_.write(std::string("root/") + file + ".pcd.bin", bytes);
    }
  }

  void table(const std::string& name, const std::string& rows) const {
    folder_.write("root/v1.0-mini/" + name + ".json", "[" + rows + "]");
  }
  static std::string scan(const char* token, const char* sample, const char* file, int stamp_us,
                          bool is_key_frame) {
    return fmt::format(R"({{"token": "{0}", "ego_pose_token": "{0}", "sample_token": "{1}",
      "filename": "{2}", "timestamp": {3}, "is_key_frame": {4}, "calibrated_sensor_token": "l"}})",
                       token, sample, file, stamp_us, is_key_frame);
  }
  static std::string pose(const char* token, const char* translation) {
    return fmt::format(R"({{"token": "{}", "translation": [{}], {}}})", token, translation,
                       kNoTurn);
  }
  static std::string box(const char* translation, const char* size, const char* attribute) {
    return fmt::format(R"({{"sample_token": "k1", "translation": {}, "size": {}, {},
      "attribute_tokens": [{}]}})",
                       translation, size, kNoTurn, attribute);
  }
  Dataset opened(const char* below = "root") const { return open_dataset(folder_ / below, {}); }
  std::string error_of_opening() const {
    return message_of<DataError>([&] { opened(); });
  }

  TempFolder folder_;
};

TEST_F(NuscenesFolder, IsReadByItsTables) {
  const Dataset dataset = opened();
  EXPECT_EQ(dataset.kind, DatasetKind::kNuscenes);
  EXPECT_THAT(dataset.remarks,
              Contains("recognised as nuscenes: the tables of v1.0-mini are there"));
  EXPECT_THAT(sequence_names(dataset), ElementsAre("scene-0061", "scene-0103"));
  const Sequence& scene = *dataset.sequences.at(0);
  ASSERT_EQ(scene.size(), 2U);
  EXPECT_EQ(scene.stem(0), "a");
  EXPECT_EQ(scene.stamp_ns(1), 1'050'000'000);
  const Frame frame = scene.read(0);
  ASSERT_EQ(frame.points.size(), 6U);
  EXPECT_EQ(frame.points[4].intensity, 5.0F);
  const Eigen::Vector3d ahead = frame.map_from_sensor * Eigen::Vector3d(0, 1, 0);
  EXPECT_LT((ahead - Eigen::Vector3d(102, 20, 2)).norm(), 1e-12);
  EXPECT_THAT(members_of(scene.reading()), Contains(Pair("pose_frame", "lidar")));
}

TEST_F(NuscenesFolder, HasTruthAtKeyFramesByBoxesOfWhatMoves) {
  const Dataset dataset = opened();
  const Sequence& scene = *dataset.sequences.at(0);
  EXPECT_THAT(*scene.read(0).truth, ElementsAre(251U, 251U, 9U, 9U, 9U, 9U));
  EXPECT_EQ(scene.read_truth(0), *scene.read(0).truth);
  EXPECT_FALSE(scene.has_truth(1)) << "a sweep";
  EXPECT_THAT(dataset.sequences.at(1)->read_truth(0), testing::Each(9U));
}

TEST_F(NuscenesFolder, MovesByTheFirstAttributeAsInMapMos) {
  const std::vector<std::pair<const char*, std::uint32_t>> cases = {
      {"\"w\"", 251}, {"\"q\"", 9}, {"\"v\"", 251}, {"\"q\", \"m\"", 9}, {"\"m\", \"q\"", 251}};
  for (const auto& [attributes, expected] : cases) {
    table("sample_annotation", box("[101, 15, 2]", "[2, 4, 1]", attributes));
    EXPECT_EQ(opened().sequences.at(0)->read_truth(0).front(), expected) << attributes;
  }
}

TEST_F(NuscenesFolder, SharesTablesUntilTheyChange) {
  const auto first = read_nuscenes_tables(folder_ / "root/v1.0-mini");
  EXPECT_EQ(read_nuscenes_tables(folder_ / "root/v1.0-mini"), first);
  table("sample_annotation", box("[101, 25, 2]", "[2, 4, 1]", "\"m\""));
  EXPECT_NE(read_nuscenes_tables(folder_ / "root/v1.0-mini"), first);
}

TEST_F(NuscenesFolder, HasNoTruthWithoutAnnotations) {
  table("sample_annotation", "");
  const Dataset dataset = opened();
  EXPECT_FALSE(dataset.sequences.at(0)->has_truth(0));
  EXPECT_THAT(dataset.sequences.at(0)->remarks(), Contains("no annotations: there is no truth"));
}

TEST_F(NuscenesFolder, IsFoundFromItsTablesAndFromAbove) {
  for (const char* place : {"root/v1.0-mini", "root", ""}) {
    const Dataset dataset = open_dataset(folder_ / place, {.sequences = {"0103"}});
    EXPECT_THAT(sequence_names(dataset), ElementsAre("scene-0103")) << place;
  }
}

TEST_F(NuscenesFolder, HasTheSplitsOfItsDevkit) {
  std::vector<std::string> names;
  for (const Split& split : opened().splits) {
    names.push_back(split.name);
    EXPECT_EQ(split.parts.size(), 1U);
  }
  EXPECT_THAT(names, ElementsAre("train", "val", "mini_train", "mini_val"));
}

TEST_F(NuscenesFolder, TakesOtherPosesAndKeepsItsTruth) {
  folder_.write("p.tum", "0.9 1 0 0 0 0 0 1\n1.2 1 0 0 0 0 0 1\n");
  const Dataset dataset = open_dataset(
      folder_ / "root",
      {.sequences = {"scene-0061"}, .reading = {.poses = PoseFile{folder_ / "p.tum"}}});
  const Frame frame = dataset.sequences.at(0)->read(0);
  EXPECT_EQ(frame.map_from_sensor.translation(), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(frame.truth->front(), 251U);
}

TEST_F(NuscenesFolder, NamesTheTableThatDoesNotFit) {
  table("ego_pose", pose("d1", "0, 0, 0") + "," + pose("d3", "0, 0, 0"));
  EXPECT_THAT(error_of_opening(), HasSubstr("ego_pose.json: has no pose of sweeps/LIDAR_TOP/b"));
  table("ego_pose", R"({"token": "d1", "translation": [0, 0, 0], "rotation": [1, 1, 0, 0]})");
  EXPECT_THAT(error_of_opening(), HasSubstr("ego_pose.json:0: \"rotation\" is no unit quaternion"));
  for (const char* file : {"../outside.pcd.bin", "/etc/passwd", "samples/../../a"}) {
    table("sample_data", scan("d1", "k1", file, 1, true));
    EXPECT_THAT(error_of_opening(),
                HasSubstr("sample_data.json:0: \"filename\" is no path within the data set"));
  }
  table("sample_data", scan("d1", "none", "a.pcd.bin", 1, true));
  EXPECT_THAT(error_of_opening(), HasSubstr("sample_data.json:0: is of no sample"));
  table("sample_data", scan("d1", "k1", "gone.pcd.bin", 1, true));
  table("ego_pose", pose("d1", "0, 0, 0"));
  EXPECT_THAT(error_of_opening(), HasSubstr("gone.pcd.bin"));
  table("sample_data", "");
  EXPECT_THAT(error_of_opening(), HasSubstr("has no scan of LIDAR_TOP in scene-0061"));
}

TEST_F(NuscenesFolder, IsKnownAndNamesTheTableThatItLacks) {
  for (const std::string lacks :
       {"scene", "sample", "sample_data", "sensor", "calibrated_sensor", "ego_pose"}) {
    const auto table = folder_ / ("root/v1.0-mini/" + lacks + ".json");
    std::filesystem::rename(table, folder_ / "away");
    for (const char* place : {"root", "root/v1.0-mini", ""}) {
      EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / place, {}); }),
                  AllOf(HasSubstr("v1.0-mini/" + lacks + ".json: is not there"),
                        HasSubstr("sample_data.json")))
          << place;
    }
    std::filesystem::rename(folder_ / "away", table);
  }
  std::filesystem::remove(folder_ / "root/v1.0-mini/attribute.json");
  EXPECT_THAT(error_of_opening(), HasSubstr("attribute.json: is not there"));
  std::filesystem::remove(folder_ / "root/v1.0-mini/sample_annotation.json");
  EXPECT_THAT(opened().sequences.front()->remarks(),
              Contains(HasSubstr("sample_annotation.json is not there")));
}

TEST_F(NuscenesFolder, NumbersTheObjectsOfAScene) {
  const auto of = [](const char* object, const char* translation) {
    std::string row = box(translation, "[2, 4, 1]", "\"m\"");
    return row.insert(row.find('{') + 1, fmt::format(R"("instance_token": "{}", )", object));
  };
  table("sample_annotation", of("a", "[901, 15, 2]") + "," + of("b", "[101, 15, 2]") + "," +
                                 of("b", "[902, 15, 2]") + "," +
                                 of("mosbench-object-300", "[101, 25, 2]") + "," +
                                 box("[101, 20, 7]", "[1, 1, 1]", "\"m\""));
  const auto truth = opened().sequences.at(0)->read_truth(0);
  EXPECT_EQ(truth.at(0), 251U + (2U << 16U));
  EXPECT_EQ(truth.at(2), 9U);
  EXPECT_EQ(truth.at(4), 251U + (300U << 16U)) << "as convert writes it";
}

TEST_F(NuscenesFolder, PrefersAVersionThatHasAllTables) {
  folder_.write("root/v1.0-test/scene.json", "[]");
  folder_.write("root/v1.0-test/sample.json", "[]");
  folder_.write("root/v1.0-test/sensor.json", "[]");
  EXPECT_EQ(opened().sequences.size(), 2U);
}

TEST_F(NuscenesFolder, IsReadWithoutItsSweepsButNotWithoutAKeyFrame) {
  std::filesystem::remove_all(folder_ / "root/sweeps");
  const Dataset dataset = opened();
  EXPECT_EQ(dataset.sequences.at(0)->size(), 1U);
  EXPECT_THAT(dataset.sequences.at(0)->recording().doubts,
              testing::Contains(HasSubstr("left out 1 sweep of")));
  std::filesystem::remove(folder_ / "root/samples/LIDAR_TOP/a.pcd.bin");
  EXPECT_THAT(error_of_opening(), HasSubstr("a.pcd.bin"));
}

TEST_F(NuscenesFolder, RefusesAPipeInsteadOfATable) {
  const auto table = folder_ / "root/v1.0-mini/sample_annotation.json";
  std::filesystem::remove(table);
  ASSERT_EQ(mkfifo(table.c_str(), 0600), 0);
  EXPECT_THAT(error_of_opening(), HasSubstr("sample_annotation.json: is no regular file"));
}

TEST_F(NuscenesFolder, NamesATableWhoseReadingFails) {
  const auto table = folder_ / "root/v1.0-mini/sample_annotation.json";
  std::filesystem::remove(table);
  // Nothing lies at the first address of a process.
  std::filesystem::create_symlink("/proc/self/mem", table);
  EXPECT_THAT(error_of_opening(),
              HasSubstr("sample_annotation.json: cannot be read (Input/output"));
}

TEST_F(NuscenesFolder, RefusesRowsThatComeTwice) {
  table("ego_pose", pose("d1", "0, 0, 0") + "," + pose("d2", "0, 0, 0") + "," +
                        pose("d3", "0, 0, 0") + "," + pose("d1", "1, 0, 0"));
  EXPECT_THAT(error_of_opening(), HasSubstr("ego_pose.json:3: has the token of another row"));
  table("scene", R"({"token": "s1", "name": "scene-0061"}, {"token": "s1", "name": "scene-0103"})");
  EXPECT_THAT(error_of_opening(), HasSubstr("scene.json:1: has the token of another row"));
  table("scene", R"({"token": "s1", "name": "scene-0061"}, {"token": "s2", "name": "scene-0061"})");
  EXPECT_THAT(
      error_of_opening(),
      HasSubstr(
          "scene.json:1: has the name \"scene-0061\" of another row, expected one row per scene"));
}

TEST_F(NuscenesFolder, RefusesScansOfOneTimestamp) {
  table("sample_data", scan("d1", "k1", "samples/LIDAR_TOP/a.pcd.bin", 1000000, true) + "," +
                           scan("d2", "k1", "sweeps/LIDAR_TOP/b.pcd.bin", 1000000, false));
  EXPECT_THAT(error_of_opening(), HasSubstr("b.pcd.bin have one timestamp"));
}

TEST_F(NuscenesFolder, RefusesAnAttributeThatNoTableKnows) {
  table("attribute", "");
  EXPECT_THAT(error_of_opening(), HasSubstr("sample_annotation.json:0: has an unknown attribute"));
}

TEST_F(NuscenesFolder, RefusesTheRingAsTimes) {
  EXPECT_THROW(open_dataset(folder_ / "root", {.reading = {.point_times = PointTimes::kColumn}}),
               UsageError);
}

TEST(NuscenesTruth, ReachesTheCornersOfATurnedBox) {
  constexpr double kEighthTurn_rad = 0.25 * 3.14159265358979;
  const Pose turned(Eigen::AngleAxisd(kEighthTurn_rad, Eigen::Vector3d::UnitZ()));
  const std::vector<NuscenesBox> boxes = {{turned, {1, 1, 1}}};
  // The corner lies at the root of 2.
  const std::vector<Point> points = {{1.41F, 0, 0, 0}, {1.42F, 0, 0, 0}, {-1.41F, 0, 0, 0}};
  EXPECT_THAT(nuscenes_truth(points, Pose::Identity(), boxes), testing::ElementsAre(251, 9, 251));
}

TEST(NuscenesTruth, IsThatOfATwinThatLooksAtAllPoints) {
  std::vector<Point> points;
  for (int i = 0; i < 4000; ++i) {
    const auto at = static_cast<float>(i);
    points.push_back({std::sin(at) * 15, std::cos(1.7F * at) * 12, std::sin(0.3F * at) * 2, 0});
  }
  points[5].x = std::numeric_limits<float>::quiet_NaN();
  Pose map_from_sensor(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  map_from_sensor.translation() << 1e5, -2e5, 10;
  std::vector<NuscenesBox> boxes(12);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto at = static_cast<double>(i);
    boxes[i].map_from_box = map_from_sensor * Eigen::Translation3d(3 * at - 15, at, 0) *
                            Eigen::AngleAxisd(at, Eigen::Vector3d(1, 2, 9).normalized());
    boxes[i].half_size_m << 3, 1.5, 1;
  }
  std::vector<std::uint32_t> expected(points.size(), 9);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const NuscenesBox& box : boxes) {
      const Eigen::Vector3d p = (box.map_from_box.inverse() * map_from_sensor) *
                                Eigen::Vector3d(points[i].x, points[i].y, points[i].z);
      if ((p.cwiseAbs().array() <= box.half_size_m.array()).all()) expected[i] = 251;
    }
  }
  ASSERT_GT(std::ranges::count(expected, 251U), 50);
  EXPECT_EQ(nuscenes_truth(points, map_from_sensor, boxes), expected);
}

}  // namespace
}  // namespace mosbench
