#include "datasets/layouts/dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "datasets/layouts/layout.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/sequence_names.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A sequence of one-point scans numbered from 0, with poses.
void write_sequence(const TempFolder& root, const std::string& below, int scans = 2) {
  std::string poses;
  for (int i = 0; i < scans; ++i) {
    root.write(below + "/velodyne/00000" + std::to_string(i) + ".bin", std::string(16, '\0'));
    poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  }
  root.write(below + "/poses.txt", poses);
}

/// "test: 00 07" for each split.
std::vector<std::string> splits(const Dataset& dataset) {
  std::vector<std::string> splits;
  for (const Split& split : dataset.splits) {
    splits.push_back(split.name + ":");
    for (const SplitPart& part : split.parts) {
      splits.back() += ' ';
      splits.back() += dataset.sequences.at(part.sequence)->name();
      if (!part.stems) continue;
      for (const std::string& stem : *part.stems) splits.back() += "/" + stem;
    }
  }
  return splits;
}

template <typename Error = DataError>
std::string error_of(const std::filesystem::path& path, const OpenOptions& options = {}) {
  return message_of<Error>([&] { open_dataset(path, options); });
}

TEST(Layouts, HaveOneCompleteRowPerDataSet) {
  std::set<DatasetKind> kinds;
  for (const Layout* row : layouts()) {
    EXPECT_TRUE(kinds.insert(row->kind()).second) << row->name;
    EXPECT_EQ(&layout_of(row->kind()), row);
    EXPECT_EQ(dataset_kind_from_string(row->name), row->kind());
    EXPECT_EQ(to_string(row->kind()), row->name);
    for (const std::string_view text : {row->title, row->content, row->size, row->published,
                                        row->licence, row->folders.front(), row->expected}) {
      EXPECT_FALSE(text.empty()) << row->name;
    }
    EXPECT_GT(row->files.sensor_range_m, 0.0) << row->name;
  }
  EXPECT_EQ(kinds.size(), 14U);
  EXPECT_EQ(dataset_kind_from_string("kitti"), std::nullopt);
}

TEST(Layouts, AreWrittenWhereTheyHaveAWriter) {
  std::vector<std::string_view> written;
  for (const Layout* row : layouts()) {
    if (row->writer) written.push_back(row->name);
  }
  EXPECT_THAT(written,
              ElementsAre("doals", "sipailou", "helimos", "semantickitti", "opensceneflow",
                          "nuscenes", "helipr", "kitti-raw", "kitti-tracking", "recording"));
}

TEST(OpenDataset, FindsSemanticKittiWithAndWithoutTheFolderSequences) {
  const TempFolder root;
  for (const char* name : {"08", "00", "11"})
    write_sequence(root, std::string("sequences/") + name);
  for (const auto& path : {root.path(), root / "sequences"}) {
    const Dataset dataset = open_dataset(path, {});
    EXPECT_EQ(dataset.kind, DatasetKind::kSemanticKitti);
    EXPECT_THAT(sequence_names(dataset), ElementsAre("00", "08", "11"));
    EXPECT_THAT(splits(dataset), ElementsAre("train: 00", "valid: 08", "test: 11"));
    EXPECT_THAT(dataset.remarks, Contains(HasSubstr("recognised as semantickitti")));
  }
}

TEST(OpenDataset, IsNotMisledByFilesBesideSequencesThatItCanRead) {
  const std::string scan(16, '\0');
  for (const auto& [file, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"features.h5", ""},
           {"features.h5", "no HDF5"},
           {"v1.0-x/scene.json", "[]"},
           {"x/v1.0-x/scene.json", "[]"},
           {"training/velodyne/0000/000000.bin", scan},
           {"sequences/00/velodyne/0001/000000.bin", scan}}) {
    const TempFolder root;
    write_sequence(root, "sequences/00");
    root.write(file, bytes);
    for (const auto& path : {root.path(), root / "sequences/00"}) {
      const Dataset dataset = open_dataset(path, {});
      EXPECT_EQ(dataset.kind, DatasetKind::kSemanticKitti) << path << file;
      EXPECT_EQ(dataset.sequences.front()->size(), 2U);
    }
  }
  const TempFolder scans;
  scans.write("000000.bin", scan);
  scans.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  scans.write("features.h5", "");
  EXPECT_EQ(open_dataset(scans.path(), {}).kind, DatasetKind::kRecording);
}

TEST(OpenDataset, TakesPartOfADataSetWhereNothingElseCanBeRead) {
  for (const auto& [file, missing] : std::vector<std::pair<std::string, std::string>>{
           {"features.h5", "features.h5: is empty"},
           {"v1.0-x/scene.json", "v1.0-x/sample.json: is not there"},
           {"velodyne/0001/000000.bin", "oxts: is not there"},
           {"00/poses.txt", "no folder of scans"}}) {
    const TempFolder root;
    root.write(file, file.ends_with(".bin") ? std::string(16, '\0') : "");
    EXPECT_THAT(error_of(root.path()), HasSubstr(missing)) << file;
  }
}

TEST(OpenDataset, KnowsTheSplitsOfKittiRoad) {
  const TempFolder root;
  for (const char* name : {"08", "30", "34", "35", "40", "41"}) {
    write_sequence(root, std::string("sequences/") + name);
  }
  EXPECT_THAT(splits(open_dataset(root.path(), {})),
              ElementsAre("valid: 08", "road-train: 30 34 40", "road-valid: 35 41"));
}

TEST(OpenDataset, TakesOneSequenceFolderNamedByItself) {
  const TempFolder root;
  write_sequence(root, "kitti_0005");
  EXPECT_THAT(sequence_names(open_dataset(root / "kitti_0005", {})), ElementsAre("kitti_0005"));
  EXPECT_THAT(sequence_names(open_dataset(root / "kitti_0005/", {})), ElementsAre("kitti_0005"));
  EXPECT_THAT(sequence_names(open_dataset(root / "kitti_0005/velodyne/..", {})),
              ElementsAre("kitti_0005"));
  EXPECT_THAT(splits(open_dataset(root / "kitti_0005", {})), IsEmpty());
}

TEST(OpenDataset, TellsSipailouByFolderNameOrWhenTold) {
  const TempFolder root;
  for (const char* folder : {"Sipailou-livox-kitti", "campus"}) {
    for (const char* name : {"00", "01", "06", "07"}) {
      write_sequence(root, std::string(folder) + "/sequences/" + name);
    }
  }
  const Dataset guessed = open_dataset(root / "Sipailou-livox-kitti", {});
  EXPECT_EQ(guessed.kind, DatasetKind::kSipailou);
  EXPECT_THAT(guessed.remarks, Contains(HasSubstr("Sipailou-livox-kitti")));
  const Dataset told = open_dataset(root / "campus", {.kind = DatasetKind::kSipailou});
  for (const Dataset* dataset : {&guessed, &told}) {
    EXPECT_THAT(splits(*dataset), ElementsAre("train: 01", "valid: 06", "test: 00 07"));
  }
  EXPECT_THAT(told.remarks, IsEmpty());
}

TEST(OpenDataset, FindsDoalsScenesAndTheirSplits) {
  const TempFolder root;
  for (const char* name :
       {"station/sequence_2", "station/sequence_1", "niederdorf/sequence_1", "market/sequence_1"}) {
    write_sequence(root, name);
  }
  const Dataset dataset = open_dataset(root.path(), {});
  EXPECT_EQ(dataset.kind, DatasetKind::kDoals);
  EXPECT_THAT(sequence_names(dataset), ElementsAre("market/sequence_1", "niederdorf/sequence_1",
                                                   "station/sequence_1", "station/sequence_2"));
  EXPECT_THAT(splits(dataset), ElementsAre("ST: station/sequence_1 station/sequence_2",
                                           "ND: niederdorf/sequence_1"));
  const Dataset scene = open_dataset(root / "station", {});
  EXPECT_THAT(sequence_names(scene), ElementsAre("sequence_1", "sequence_2"));
  EXPECT_THAT(splits(scene), ElementsAre("ST: sequence_1 sequence_2"));
  const Dataset one = open_dataset(root / "station/sequence_2", {});
  EXPECT_EQ(one.kind, DatasetKind::kDoals);
  EXPECT_THAT(sequence_names(one), ElementsAre("sequence_2"));
}

TEST(OpenDataset, TellsDoalsByIndices) {
  const TempFolder root;
  write_sequence(root, "mine");
  root.write("mine/times.txt", "1\n2\n");
  root.write("mine/indices.csv", "2000000000,0\n");
  const Dataset dataset = open_dataset(root / "mine", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kDoals);
  EXPECT_TRUE(dataset.sequences[0]->has_truth(1));
}

TEST(OpenDataset, KeepsTheSequencesAskedForByNameOrDoalsNumber) {
  const TempFolder root;
  for (const char* name :
       {"station/sequence_1", "niederdorf/sequence_1", "niederdorf/sequence_2"}) {
    write_sequence(root, name);
  }
  EXPECT_THAT(
      sequence_names(open_dataset(root.path(), {.sequences = {"7", "niederdorf/sequence_2"}})),
      ElementsAre("niederdorf/sequence_2", "station/sequence_1"));
  EXPECT_THAT(error_of<UsageError>(root.path(), {.sequences = {"8"}}),
              AllOf(HasSubstr("no sequence \"8\""), HasSubstr("niederdorf/sequence_1")));
}

TEST(OpenDataset, FindsHelimosSensorsInEveryPublishedPlace) {
  const TempFolder root;
  const std::vector<std::string> places = {"a/KAIST05/Deskewed_LiDAR", "b/deskewed_LiDAR", "c"};
  for (const std::string& place : places) {
    for (const char* sensor : {"Velodyne", "Aeva", "Ouster", "Avia"}) {
      write_sequence(root, place + "/" + sensor);
    }
  }
  for (const char* top : {"a", "a/KAIST05", "a/KAIST05/Deskewed_LiDAR", "b", "c"}) {
    const Dataset dataset = open_dataset(root / top, {});
    EXPECT_EQ(dataset.kind, DatasetKind::kHelimos) << top;
    EXPECT_THAT(sequence_names(dataset), ElementsAre("Aeva", "Avia", "Ouster", "Velodyne")) << top;
    EXPECT_THAT(splits(dataset), ElementsAre("all: Aeva Avia Ouster Velodyne")) << top;
  }
}

TEST(OpenDataset, PairsHelimosSplitsByNumberAlsoForOneSensorFolder) {
  const TempFolder root;
  write_sequence(root, "Aeva", 4);
  write_sequence(root, "Velodyne", 3);
  root.write("Aeva/labels/000001.label", std::string(4, '\0'));
  root.write("test.txt", "1\n2\n");
  root.write("val.txt", "00000\n");
  root.write("train.txt", "3\n");
  const Dataset dataset = open_dataset(root.path(), {});
  EXPECT_THAT(splits(dataset),
              ElementsAre("all: Aeva Velodyne", "test: Aeva/000001/000002 Velodyne/000001/000002",
                          "val: Aeva/000000 Velodyne/000000", "train: Aeva/000003"));
  EXPECT_THAT(dataset.remarks,
              AllOf(Contains("Aeva: 1 of the frames in test.txt have no label and do not count"),
                    Contains("Velodyne: 1 of the frames in train.txt lie after the end of the "
                             "recording and are left out")));
  const Dataset one = open_dataset(root / "Velodyne", {});
  EXPECT_EQ(one.kind, DatasetKind::kHelimos);
  EXPECT_THAT(splits(one), Contains("test: Velodyne/000001/000002"));
}

TEST(OpenDataset, RefusesAHelimosSplitThatNamesAbsentScans) {
  const TempFolder root;
  write_sequence(root, "Aeva", 2);
  root.write("test.txt", "1\n4\n");
  EXPECT_THAT(error_of(root.path()),
              AllOf(HasSubstr("test.txt: names frame 4, which Aeva does not have")));
  std::filesystem::remove(root / "Aeva/velodyne/000000.bin");
  root.write("Aeva/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  root.write("test.txt", "0\n1\n");
  EXPECT_THAT(error_of(root.path()), HasSubstr("names frame 0"));
}

TEST(OpenDataset, SaysWhichLayoutItExpected) {
  const TempFolder root;
  EXPECT_THAT(error_of(root / "absent"),
              AllOf(HasSubstr("absent"), HasSubstr("is no folder that can be listed")));
  EXPECT_THAT(error_of(root.path()), AllOf(HasSubstr("holds no sequence"), HasSubstr("velodyne/")));
  const std::pair<DatasetKind, const char*> layouts[] = {
      {DatasetKind::kDoals, "<scene>/sequence_N"},
      {DatasetKind::kHelimos, "Deskewed_LiDAR"},
      {DatasetKind::kSipailou, "sequences/00 to 07"},
      {DatasetKind::kSemanticKitti, "sequences/NN"}};
  for (const auto& [kind, layout] : layouts) {
    EXPECT_THAT(error_of(root.path(), {.kind = kind}), HasSubstr(layout));
  }
}

TEST(OpenDataset, NamesTheSequenceWithoutScansInsteadOfPassingOverIt) {
  const TempFolder root;
  write_sequence(root, "sequences/00");
  root.write("sequences/01/poses.txt", "");
  EXPECT_THAT(error_of(root.path()),
              AllOf(HasSubstr("sequences/01"), HasSubstr("no folder of scans")));
  EXPECT_THAT(sequence_names(open_dataset(root.path(), {.sequences = {"00"}})), ElementsAre("00"));
}

TEST(OpenDataset, TakesAPoseFileForOneSequenceOnly) {
  const TempFolder root;
  write_sequence(root, "00", 1);
  write_sequence(root, "01", 1);
  const auto poses = root.write("other.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  const Dataset dataset =
      open_dataset(root.path(), {.sequences = {"01"}, .reading = {.poses = PoseFile{poses}}});
  EXPECT_EQ(dataset.sequences[0]->read(0).map_from_sensor.translation().x(), 7.0);
  EXPECT_THAT(error_of<UsageError>(root.path(), {.reading = {.poses = PoseFile{poses}}}),
              HasSubstr("poses is for one"));
}

}  // namespace
}  // namespace mosbench
