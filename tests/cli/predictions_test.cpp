// Predictions of other programs, in each of their formats, made from one run's labels: all must
// give the run's numbers, and no file that is lost, cut, renamed or doubled may go unnoticed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kScansPredicted = 8;

class PredictionsTest : public testing::Test {
 protected:
  PredictionsTest() {
    cli::write_small_sequence(folder_ / "room", kScansPredicted);
    for (std::size_t k = 0; k < kScansPredicted; ++k) predicted_.push_back(wrong_in_places(k));
    write(
        "labels", [](const std::string& stem) { return stem + ".label"; },
        [](const std::vector<std::uint32_t>& labels) {
          return std::string(format_labels(labels));
        });
    expected_ = summary(score(folder_ / "labels"));
  }

  /// The truth with some points turned over.
  std::vector<std::uint32_t> wrong_in_places(std::size_t k) const {
    auto labels =
        read_labels(folder_ / "room/labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
    for (std::size_t i = k; i < labels.size(); i += 37) {
      labels[i] = labels[i] == kMovingLabel ? kStaticLabel : kMovingLabel;
    }
    return labels;
  }

  static std::int64_t stamp_ns(std::size_t k) {
    return 1582000000000000000 + 100000000 * static_cast<std::int64_t>(k);
  }
  void give_stamps() const {
    std::vector<std::int64_t> stamps_ns;
    for (std::size_t k = 0; k < kScansPredicted; ++k) stamps_ns.push_back(stamp_ns(k));
    write_times(folder_ / "room/times.txt", stamps_ns);
  }

  void write(const std::string& folder, const std::function<std::string(std::string)>& name,
             const std::function<std::string(const std::vector<std::uint32_t>&)>& bytes) const {
    for (std::size_t k = 0; k < kScansPredicted; ++k) {
      write_file_atomic(folder_ / folder / name(cli::stem(k)), bytes(predicted_[k]));
    }
  }

  cli::Answer score(const fs::path& predictions, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"score", (folder_ / "room").string(), "--json",
                                      "--predictions", predictions.string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }
  static nlohmann::json summary(const cli::Answer& answer) {
    if (answer.exit_code != 0) return answer.err;
    return nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary");
  }
  static std::string format(const cli::Answer& answer) {
    return nlohmann::json::parse(answer.out).at("predictions").at("room").at("format");
  }

  TempFolder folder_;
  std::vector<std::vector<std::uint32_t>> predicted_;
  nlohmann::json expected_;
};

/// The name of a file of no scan.
std::string other_name(std::string name) {
  name.front() = '1';
  return name;
}

std::string rows_of_points(const std::vector<std::uint32_t>& labels, const char* moving,
                           const char* standing) {
  std::string text;
  for (const std::uint32_t label : labels) text += label == kMovingLabel ? moving : standing;
  return text;
}

TEST_F(PredictionsTest, OfEveryFormatPerScanGiveTheSameNumbers) {
  ASSERT_GT(expected_.at("tp"), 100);
  ASSERT_GT(expected_.at("fp"), 100);
  write(
      "moe", [](const std::string& stem) { return stem + ".txt"; },
      [](const auto& labels) { return rows_of_points(labels, "1 1 3\n", "1 0 -1\n"); });
  // MOE's class is -1 where nothing moves: only column 2 is read.
  write(
      "moe-submission", [](const std::string& stem) { return stem + ".txt"; },
      [](const auto& labels) { return rows_of_points(labels, "1\n", "0\n"); });
  write(
      "csv", [](const std::string& stem) { return stem + ".csv"; },
      [](const auto& labels) {
        return "index,moving\n" + rows_of_points(labels, "0,1\n", "0,0\n");
      });
  write(
      "csv-ids", [](const std::string& stem) { return stem + ".csv"; },
      [](const auto& labels) { return "label\n" + rows_of_points(labels, "252\n", "9\n"); });
  for (const auto& [folder, name] : {std::pair{"moe", "text"}, std::pair{"moe-submission", "text"},
                                     std::pair{"csv", "csv"}, std::pair{"csv-ids", "csv"}}) {
    const cli::Answer answer = score(folder_ / folder);
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_EQ(summary(answer), expected_) << folder;
    EXPECT_EQ(format(answer), name);
    EXPECT_EQ(summary(score(folder_ / folder, {"--format", name})), expected_);
  }
}

/// A .pcd file with an intensity per point at the origin.
std::string pcd_with(const std::vector<std::string>& intensities) {
  std::string text =
      "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n";
  text += "WIDTH " + std::to_string(intensities.size()) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n";
  text += "POINTS " + std::to_string(intensities.size()) + "\nDATA ascii\n";
  for (const std::string& intensity : intensities) text += "0 0 0 " + intensity + '\n';
  return text;
}

std::string pcd_of(const std::vector<std::uint32_t>& labels, const char* moving,
                   const char* standing) {
  std::vector<std::string> intensities;
  for (const std::uint32_t label : labels) {
    intensities.emplace_back(label == kMovingLabel ? moving : standing);
  }
  return pcd_with(intensities);
}

TEST_F(PredictionsTest, OfKthInTheIntensityOfPcdFilesGiveTheSameNumbers) {
  const auto name = [](const std::string& stem) { return stem + ".pcd"; };
  write("kth", name, [](const auto& labels) { return pcd_of(labels, "1", "0"); });
  // ERASOR writes label numbers.
  write("erasor", name, [](const auto& labels) { return pcd_of(labels, "252", "40"); });
  for (const char* folder : {"kth", "erasor"}) {
    const cli::Answer guessed = score(folder_ / folder);
    ASSERT_EQ(guessed.exit_code, 0) << guessed.err;
    EXPECT_EQ(format(guessed), "pcd");
    EXPECT_EQ(summary(guessed), expected_) << folder;
    EXPECT_EQ(summary(score(folder_ / folder, {"--format", "pcd"})), expected_) << folder;
  }
  const fs::path file = folder_ / "kth/000003.pcd";
  const std::string whole = read_file(file);
  const auto error_of = [&](const std::string& bytes) {
    write_file_atomic(file, bytes);
    const cli::Answer answer = score(folder_ / "kth", {"--format", "pcd"});
    EXPECT_EQ(answer.exit_code, 3);
    return answer.err;
  };
  EXPECT_THAT(error_of(pcd_with(std::vector<std::string>(7, "1"))),
              HasSubstr("000003.pcd: has 7 points"));
  EXPECT_THAT(error_of(pcd_with(std::vector<std::string>(cli::kPointsPerScan, "0.5"))),
              HasSubstr("000003.pcd: has intensity 0.5"));
  EXPECT_THAT(error_of(whole.substr(0, whole.size() / 2)), HasSubstr("000003.pcd"));
}

TEST_F(PredictionsTest, InOneFileGiveTheSameNumbers) {
  std::string rows;
  std::string indices;
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    std::string moving;
    for (std::size_t i = 0; i < predicted_[k].size(); ++i) {
      if (predicted_[k][i] == kMovingLabel) moving += ',' + std::to_string(i);
    }
    rows += std::to_string(k + 1) + moving + '\n';
    indices += std::to_string(1582000000000000000 + k) + moving + '\n';
  }
  const fs::path row_file = folder_.write("rows/room.txt", rows);
  const fs::path index_file = folder_.write("indices/indices.csv", indices);
  for (const auto& [path, name] :
       {std::pair{row_file, "rows"}, std::pair{index_file, "indices"},
        std::pair{folder_ / "rows", "rows"}, std::pair{folder_ / "indices", "indices"}}) {
    const cli::Answer answer = score(path);
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_EQ(summary(answer), expected_) << path;
    EXPECT_EQ(format(answer), name);
  }
  folder_.write("rows/room.txt", rows.substr(rows.find('\n') + 1));
  EXPECT_THAT(score(row_file).err, HasSubstr("room.txt: has no row for scan 000000"));
  folder_.write("rows/room.txt", rows + "9,5\n");
  EXPECT_THAT(score(row_file).err, HasSubstr("room.txt:9: is of scan 9"));
  folder_.write("rows/room.txt", "1,8640\n" + rows.substr(rows.find('\n') + 1));
  EXPECT_THAT(score(row_file).err, HasSubstr("room.txt:1"));
}

TEST_F(PredictionsTest, OfDynabloxAreReadAtEachLevelAndItsOwnCountsTaken) {
  give_stamps();
  std::string clouds =
      "CloudNo,X,Y,Z,Distance,PointDynamic,ClusterDynamic,ObjectDynamic,GTDynamic,"
      "ReadyForEvaluation,ClusterID\n";
  std::string scores =
      "timestamp,point_IoU,point_Precision,point_Recall,point_TP,point_TN,point_FP,point_FN";
  scores += ",c,c,c,c,c,c,c,o,o,o,o,o,o,o,EvaluatedPoints,TotalPoints\n";
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    for (const std::uint32_t label : predicted_[k]) {
      const std::string moving = label == kMovingLabel ? "1" : "0";
      clouds += std::to_string(k) + ",1.5,-2,0,3.25,0," + moving + ",0,0,1,-1\n";
    }
    scores += std::to_string(stamp_ns(k)) +
              ",0.5,0.5,0.5,0,8640,0,0,0.5,0.5,0.5,0,8640,0,0,0.5,1,0.5,7,8600,";
    scores += "0,7,8614,8640\n";
  }
  folder_.write("dynablox/clouds.csv", clouds);
  EXPECT_THAT(score(folder_ / "dynablox").err,
              HasSubstr("scores.csv: does not exist, expected the stamps of the clouds"));
  folder_.write("dynablox/scores.csv", scores);
  const cli::Answer cluster = score(folder_ / "dynablox", {"--level", "cluster"});
  ASSERT_EQ(cluster.exit_code, 0) << cluster.err;
  EXPECT_EQ(summary(cluster), expected_);
  EXPECT_EQ(format(cluster), "dynablox-clouds");
  EXPECT_EQ(summary(score(folder_ / "dynablox")).at("tp"), 0) << "object level is the default";

  folder_.write("scores/scores.csv", scores);
  const cli::Answer counted = score(folder_ / "scores", {"--protocol", "doals-dynablox"});
  ASSERT_EQ(counted.exit_code, 0) << counted.err;
  EXPECT_EQ(summary(counted).at("tp"), 7 * kScansPredicted);
  EXPECT_EQ(summary(counted).at("iou"), 0.5);
  EXPECT_EQ(format(counted), "dynablox-scores");

  for (const std::vector<std::string>& other : std::vector<std::vector<std::string>>{
           {"--protocol", "mapmos", "--range", "0,3"},
           {"--protocol", "all"},
           {"--protocol", "doals-hmm"},
           {"--protocol", "doals-dynablox", "--range", "0.5,30"}}) {
    const cli::Answer refused = score(folder_ / "scores", other);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err,
                HasSubstr("scores.csv holds counts by protocol doals-dynablox at 0.5 to 20 m"));
  }

  folder_.write("dynablox/clouds.csv", clouds.substr(0, clouds.rfind("7,1.5")));
  EXPECT_THAT(score(folder_ / "dynablox").err, HasSubstr("has 8639 points in cloud 7"));
}

/// All sequences of DOALS have ten labelled scans of as many points.
TEST_F(PredictionsTest, OfDynabloxForAnotherSequenceAreRefused) {
  std::string scores = "timestamp,EvaluatedPoints,TotalPoints\n";
  std::string counted = "timestamp,p,p,p,p,p,p,p,c,c,c,c,c,c,c,o,o,o,o,o,o,o,EvaluatedPoints,T\n";
  std::string clouds = "CloudNo,ObjectDynamic\n";
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    const std::string stamp = std::to_string(k == 3 ? 7 : stamp_ns(k));
    scores += stamp + ",8640,8640\n";
    counted += stamp + ",1,1,1,0,8640,0,0,1,1,1,0,8640,0,0,1,1,1,0,8640,0,0,8640,8640\n";
    for (std::size_t i = 0; i < cli::kPointsPerScan; ++i) clouds += std::to_string(k) + ",0\n";
  }
  folder_.write("clouds/clouds.csv", clouds);
  folder_.write("clouds/scores.csv", scores);
  folder_.write("scores/scores.csv", counted);
  const auto error_of = [&](const char* folder) {
    const cli::Answer answer = score(folder_ / folder, {"--protocol", "doals-dynablox"});
    EXPECT_EQ(answer.exit_code, 3);
    return answer.err;
  };
  for (const char* folder : {"clouds", "scores"}) {
    EXPECT_THAT(error_of(folder), HasSubstr("scores.csv: cannot be compared with sequence room"));
  }
  give_stamps();
  for (const char* folder : {"clouds", "scores"}) {
    EXPECT_THAT(error_of(folder),
                HasSubstr("scores.csv:5: has stamp 7, expected that of labelled scan 000003, "
                          "1582000000300000000"));
  }
  folder_.write("clouds/scores.csv", scores.substr(0, scores.rfind("15820")));
  EXPECT_THAT(error_of("clouds"), HasSubstr("expected that of labelled scan 000003"));
}

TEST_F(PredictionsTest, NamedByPositionAreRecognised) {
  for (std::size_t k = kScansPredicted; k-- > 0;) {
    for (const char* name : {"room/velodyne/", "room/labels/"}) {
      const std::string extension = std::string(name).ends_with("velodyne/") ? ".bin" : ".label";
      fs::rename(folder_ / (name + cli::stem(k) + extension),
                 folder_ / (name + cli::stem(k + 500) + extension));
    }
  }
  const cli::Answer answer = score(folder_ / "labels");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(summary(answer), expected_);
  EXPECT_EQ(format(answer), "label-index");
  fs::remove(folder_ / "labels/000003.label");
  EXPECT_EQ(score(folder_ / "labels").exit_code, 3);
  EXPECT_THAT(score(folder_ / "labels", {"--format", "label-index"}).err,
              HasSubstr("000003.label: is not there"));
}

TEST_F(PredictionsTest, CutByRangeAreSpreadOverTheirScans) {
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    const std::vector<Point> points = read_bin(folder_ / "room/velodyne" / (cli::stem(k) + ".bin"));
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double range_m = std::sqrt(static_cast<double>(points[i].x) * points[i].x +
                                       static_cast<double>(points[i].y) * points[i].y +
                                       static_cast<double>(points[i].z) * points[i].z);
      if (range_m >= 4.0) kept.push_back(predicted_[k][i]);
    }
    ASSERT_LT(kept.size(), points.size());
    write_labels(folder_ / "masked" / (cli::stem(k) + ".label"), kept);
  }
  const cli::Answer answer = score(folder_ / "masked");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(format(answer), "label-masked");
  EXPECT_THAT(answer.out, HasSubstr("points from 4 m only"));
  EXPECT_LT(summary(answer).at("tp"), expected_.at("tp"));
  EXPECT_EQ(summary(score(folder_ / "masked", {"--mask", "4,-1"})), summary(answer));
  EXPECT_THAT(score(folder_ / "masked", {"--mask", "3,-1"}).err, HasSubstr("has "));
  fs::resize_file(folder_ / "masked/000006.label",
                  fs::file_size(folder_ / "masked/000006.label") - 4);
  EXPECT_THAT(score(folder_ / "masked").err, HasSubstr("000006.label: has "));
}

TEST_F(PredictionsTest, WithClassNumbersAreMappedOrRefused) {
  const auto classes = [this](const char* folder, std::uint32_t standing, std::uint32_t moving) {
    for (std::size_t k = 0; k < kScansPredicted; ++k) {
      std::vector<std::uint32_t> ids;
      for (const std::uint32_t label : predicted_[k]) {
        ids.push_back(label == kMovingLabel ? moving : standing);
      }
      write_labels(folder_ / folder / (cli::stem(k) + ".label"), ids);
    }
  };
  classes("learning", 1, 2);
  const cli::Answer guessed = score(folder_ / "learning");
  ASSERT_EQ(guessed.exit_code, 0) << guessed.err;
  EXPECT_EQ(summary(guessed), expected_);
  EXPECT_THAT(guessed.out, HasSubstr("0:0,1:9,2:251"));
  classes("binary", 0, 1);
  EXPECT_THAT(score(folder_ / "binary").err, HasSubstr("holds no other ids than 0 and 1"));
  EXPECT_EQ(summary(score(folder_ / "binary", {"--id-map", "0:9,1:251"})), expected_);
  EXPECT_THAT(score(folder_ / "binary", {"--id-map", "1:251"}).err, HasSubstr("holds id 0"));
  EXPECT_EQ(score(folder_ / "binary", {"--id-map", "1=251"}).exit_code, 2);
}

TEST_F(PredictionsTest, NoLostCutRenamedOrDoubledPredictionGoesUnnoticed) {
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    const std::string name = cli::stem(k) + ".label";
    const fs::path file = folder_ / "labels" / name;
    const std::string bytes = read_file(file);
    const auto refused = [&](const std::string& named) {
      const cli::Answer answer = score(folder_ / "labels");
      EXPECT_EQ(answer.exit_code, 3) << named;
      EXPECT_THAT(answer.err, HasSubstr(named));
    };
    fs::rename(file, folder_ / "aside");
    refused(name + ": is not there");
    fs::copy_file(folder_ / "aside", folder_ / "labels" / other_name(name));
    refused(other_name(name) + ": belongs to no scan");
    fs::remove(folder_ / "labels" / other_name(name));
    write_file_atomic(file, bytes.substr(4));
    refused(name + ": has ");
    write_file_atomic(file, bytes);
    const fs::path twice = folder_ / "labels" / (cli::stem(k) + " (copy).label");
    fs::copy_file(file, twice);
    refused("(copy).label: belongs to no scan");
    fs::remove(twice);
  }
  EXPECT_EQ(summary(score(folder_ / "labels")), expected_);
}

TEST_F(PredictionsTest, NoLostCutRenamedOrDoubledTruthGoesUnnoticed) {
  for (std::size_t k = 0; k < kScansPredicted; ++k) {
    const std::string name = cli::stem(k) + ".label";
    const fs::path file = folder_ / "room/labels" / name;
    const std::string bytes = read_file(file);
    fs::remove(file);
    const cli::Answer lost = score(folder_ / "labels");
    ASSERT_EQ(lost.exit_code, 0) << lost.err;
    EXPECT_THAT(lost.out,
                HasSubstr("1 of 8 scans have no truth and are not scored: " + cli::stem(k)));
    for (const std::string& other : {other_name(name), cli::stem(k) + " (copy).label"}) {
      write_file_atomic(folder_ / "room/labels" / other, bytes);
      EXPECT_THAT(score(folder_ / "labels").err, HasSubstr(other));
      fs::remove(folder_ / "room/labels" / other);
    }
    write_file_atomic(file, bytes.substr(4));
    EXPECT_THAT(score(folder_ / "labels").err, HasSubstr(name));
    write_file_atomic(file, bytes);
  }
  EXPECT_EQ(summary(score(folder_ / "labels")), expected_);
}

TEST_F(PredictionsTest, MissingOnesAreMarkedWhenAllowed) {
  fs::remove(folder_ / "labels/000002.label");
  fs::resize_file(folder_ / "labels/000003.label", 100);
  fs::copy_file(folder_ / "labels/000001.label", folder_ / "labels/000100.label");
  const cli::Answer answer =
      score(folder_ / "labels", {"--allow-missing", "--out", (folder_ / "out").string()});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(summary(answer).at("labelled_scans"), kScansPredicted - 2);
  const auto opened = nlohmann::json::parse(answer.out).at("predictions").at("room");
  EXPECT_EQ(opened.at("missing"), (nlohmann::json{"000002", "000003"}));
  EXPECT_THAT(answer.out, HasSubstr("000100.label: belongs to no scan"));
  EXPECT_THAT(answer.out, HasSubstr("INCOMPLETE: 2 scans"));
  const auto result = nlohmann::json::parse(read_file(folder_ / "out/room/result.json"));
  EXPECT_EQ(result.at("predictions").at("missing").size(), 2U);
}

TEST_F(PredictionsTest, AreScoredByAllProtocolsSideBySide) {
  const cli::Answer answer = score(folder_ / "labels", {"--protocol", "all"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto rows = nlohmann::json::parse(answer.out).at("protocols");
  ASSERT_GE(rows.size(), 10U);
  for (const auto& row : rows) {
    const cli::Answer alone = score(folder_ / "labels", {"--protocol", row.at("name")});
    EXPECT_EQ(summary(alone).at("published_text"), row.at("published_text")) << row;
    EXPECT_FALSE(row.at("why").get<std::string>().empty());
  }
  EXPECT_EQ(score(folder_ / "labels", {"--protocol", "all", "--out", "x"}).exit_code, 2);
}

TEST_F(PredictionsTest, GiveTheSameResultFileForAnyNumberOfThreads) {
  for (const char* threads : {"1", "3"}) {
    const std::vector<std::string> more = {"--threads", threads, "--protocol",
                                           "doals-hmm", "--out", (folder_ / threads).string()};
    ASSERT_EQ(score(folder_ / "labels", more).exit_code, 0);
  }
  EXPECT_EQ(read_file(folder_ / "1/room/result.json"), read_file(folder_ / "3/room/result.json"));
}

/// A .npy file of numbers of a type.
template <typename Number>
std::string npy(const std::vector<Number>& numbers, const std::string& type = "<f4") {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(numbers.size()) + ",), }";
  header.resize(118, ' ');
  header.back() = '\n';
  std::string bytes = "\x93NUMPY";
  bytes += {'\1', '\0', static_cast<char>(header.size()), '\0'};
  bytes += header;
  return bytes.append(reinterpret_cast<const char*>(numbers.data()),
                      numbers.size() * sizeof(Number));
}

std::string confidences(const std::vector<std::uint32_t>& labels) {
  std::vector<float> numbers;
  for (const std::uint32_t label : labels) numbers.push_back(label == kMovingLabel ? 0.7F : 0.5F);
  return npy(numbers);
}

TEST_F(PredictionsTest, OfConfidencesAreMovingAboveOneHalf) {
  const auto file_of = [](const std::string& stem) { return stem + ".npy"; };
  write("confident", file_of, confidences);
  EXPECT_EQ(summary(score(folder_ / "confident")), expected_);
  EXPECT_EQ(format(score(folder_ / "confident")), "npy");
  const std::string scored = folder_ / "scored";
  const auto known = nlohmann::json::parse(score(folder_ / "confident", {"--out", scored}).out);
  const cli::Answer curve = cli::run({"stats", scored, "--by", "threshold", "--json"});
  ASSERT_EQ(curve.exit_code, 0) << curve.err;
  EXPECT_EQ(nlohmann::json::parse(curve.out).at("average_precision"),
            known.at("confidences").at("average_precision"));
  // As 4DMOS leaves them: a folder per scan, with what it says of earlier scans as well.
  write(
      "4dmos/confidences/room",
      [](const std::string& stem) { return stem + "/" + stem + "_dt_1e-01.npy"; }, confidences);
  for (std::size_t k = 1; k < kScansPredicted; ++k) {
    const std::string earlier = cli::stem(k) + "/" + cli::stem(k - 1) + "_dt_1e-01.npy";
    write_file_atomic(folder_ / "4dmos/confidences/room" / earlier, npy<float>({0.9F}));
  }
  EXPECT_EQ(summary(score(folder_ / "4dmos")), expected_);
  write_file_atomic(folder_ / "confident/000003.npy", npy<float>({0.5F, 1.5F}));
  EXPECT_THAT(score(folder_ / "confident").err,
              HasSubstr("000003.npy: holds 2 numbers, expected one for each of the 8640 points"));
  write_file_atomic(folder_ / "confident/000003.npy", "no array");
  EXPECT_THAT(score(folder_ / "confident").err, HasSubstr("000003.npy: is no .npy file"));
}

TEST_F(PredictionsTest, OfIntegersInNumpyFilesAreLabels) {
  const auto file_of = [](const std::string& stem) { return stem + ".npy"; };
  write("ids", file_of, [](const auto& labels) { return npy(labels, "<u4"); });
  EXPECT_EQ(summary(score(folder_ / "ids")), expected_);
  for (const int still : {0, 1}) {
    const std::string name = still == 0 ? "flags" : "classes";
    write(name, file_of, [&](const std::vector<std::uint32_t>& labels) {
      std::vector<std::uint8_t> classes;
      for (const std::uint32_t label : labels) {
        classes.push_back(static_cast<std::uint8_t>(still + (label == kMovingLabel ? 1 : 0)));
      }
      return npy(classes, "|u1");
    });
    const std::vector<std::string> map = {"--id-map", still == 0 ? "0:9,1:251" : "1:9,2:251"};
    EXPECT_EQ(summary(score(folder_ / name, map)), expected_) << name;
  }
  // Flags, or the classes of a network that found nothing moving: turned round nobody would know.
  EXPECT_THAT(score(folder_ / "flags").err, HasSubstr("holds no other ids than 0 and 1"));
  EXPECT_EQ(summary(score(folder_ / "classes")), expected_);
  EXPECT_THAT(score(folder_ / "classes").out, HasSubstr("taken for a network's classes"));
  write_file_atomic(folder_ / "ids/000003.npy", npy<float>({0.5F}));
  EXPECT_THAT(score(folder_ / "ids").err,
              HasSubstr("000003.npy: holds reals, and those before integers, expected label ids"));
  write_file_atomic(folder_ / "ids/000003.npy", npy<std::uint32_t>({9, 251}, "<u4"));
  EXPECT_THAT(score(folder_ / "ids").err, HasSubstr("000003.npy: has 2 labels, expected one for"));
}

TEST_F(PredictionsTest, NamedByPositionMayHaveNoLeadingZeros) {
  write(
      "short", [](const std::string& stem) { return std::to_string(std::stoi(stem)) + ".label"; },
      [](const auto& labels) { return std::string(format_labels(labels)); });
  EXPECT_EQ(summary(score(folder_ / "short", {"--format", "label-index"})), expected_);
}

}  // namespace
}  // namespace mosbench
