#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "datasets/formats/label_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kScans = 6;

/// One way to spoil a sequence, and what the error has to name.
struct Spoiled {
  const char* name;
  std::function<void(const fs::path& sequence)> spoil;
  const char* file;
};

void PrintTo(const Spoiled& spoiled, std::ostream* out) { *out << spoiled.name; }

std::string pose_rows(std::size_t rows, const std::string& last_row) {
  std::string text;
  for (std::size_t i = 0; i + 1 < rows; ++i) text += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  return text + last_row + "\n";
}

class BadInput : public testing::TestWithParam<Spoiled> {};

TEST_P(BadInput, EndsWithExitCode3NamesTheFileAndLeavesEarlierOutputs) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", kScans);
  const std::vector<std::string> command = {"run", (folder / "room").string(), "--out",
                                            (folder / "out").string()};
  ASSERT_EQ(cli::run(command).exit_code, 0);
  const auto before = cli::contents(folder / "out");
  GetParam().spoil(folder / "room");
  const cli::Answer answer = cli::run(command);
  EXPECT_EQ(answer.exit_code, 3) << answer.err;
  EXPECT_THAT(answer.err, HasSubstr("mosbench: "));
  EXPECT_THAT(answer.err, HasSubstr(GetParam().file));
  EXPECT_THAT(answer.err, HasSubstr("expected"));
  EXPECT_EQ(answer.out, "");
  EXPECT_EQ(cli::contents(folder / "out"), before);

  std::vector<std::string> anew = command;
  anew.emplace_back("--overwrite");
  EXPECT_EQ(cli::run(anew).exit_code, 3);
  EXPECT_EQ(cli::contents(folder / "out"), before);
}

INSTANTIATE_TEST_SUITE_P(
    Files, BadInput,
    testing::Values(
        Spoiled{"missing_folder", [](const fs::path& room) { fs::remove_all(room); }, "room"},
        Spoiled{"empty_folder",
                [](const fs::path& room) {
                  fs::remove_all(room);
                  fs::create_directory(room);
                },
                "room"},
        Spoiled{"empty_velodyne",
                [](const fs::path& room) {
                  fs::remove_all(room / "velodyne");
                  fs::remove_all(room / "labels");
                  fs::create_directory(room / "velodyne");
                },
                "room"},
        Spoiled{"bin_of_17_bytes",
                [](const fs::path& room) { fs::resize_file(room / "velodyne/000002.bin", 17); },
                "000002.bin"},
        Spoiled{"too_few_poses",
                [](const fs::path& room) {
                  write_file_atomic(room / "poses.txt",
                                    pose_rows(kScans - 1, "1 0 0 0 0 1 0 0 0 0 1 0"));
                },
                "poses.txt"},
        Spoiled{"too_many_poses",
                [](const fs::path& room) {
                  write_file_atomic(room / "poses.txt",
                                    pose_rows(kScans + 1, "1 0 0 0 0 1 0 0 0 0 1 0"));
                },
                "poses.txt"},
        Spoiled{"pose_of_11_numbers",
                [](const fs::path& room) {
                  write_file_atomic(room / "poses.txt", pose_rows(kScans, "1 0 0 0 0 1 0 0 0 0 1"));
                },
                "poses.txt:6"},
        Spoiled{"pose_with_text",
                [](const fs::path& room) {
                  write_file_atomic(room / "poses.txt",
                                    pose_rows(kScans, "1 0 0 x 0 1 0 0 0 0 1 0"));
                },
                "poses.txt:6"},
        Spoiled{"pose_that_scales",
                [](const fs::path& room) {
                  write_file_atomic(room / "poses.txt",
                                    pose_rows(kScans, "2 0 0 0 0 2 0 0 0 0 2 0"));
                },
                "poses.txt:6"},
        Spoiled{"no_poses", [](const fs::path& room) { fs::remove(room / "poses.txt"); },
                "poses.txt"},
        Spoiled{"calib_without_tr",
                [](const fs::path& room) {
                  write_file_atomic(room / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
                },
                "calib.txt"},
        Spoiled{"label_too_short",
                [](const fs::path& room) { fs::resize_file(room / "labels/000003.label", 40); },
                "000003.label"},
        Spoiled{"label_without_scan",
                [](const fs::path& room) {
                  fs::copy_file(room / "labels/000003.label", room / "labels/000009.label");
                },
                "000009.label"}),
    [](const auto& spoiled) { return std::string(spoiled.param.name); });

class SpoiledRun : public testing::Test {
 protected:
  SpoiledRun() { cli::write_small_sequence(folder_ / "room", kScans); }
  cli::Answer run() const {
    return cli::run(
        {"run", (folder_ / "room").string(), "--out", (folder_ / "out").string(), "--json"});
  }

  TempFolder folder_;
};

TEST_F(SpoiledRun, CountsNanAndInfinitePointsAndLabelsThemStatic) {
  std::vector<Point> points = read_bin(folder_ / "room/velodyne/000005.bin");
  points[0].x = std::numeric_limits<float>::quiet_NaN();
  points[1].y = std::numeric_limits<float>::infinity();
  write_bin(folder_ / "room/velodyne/000005.bin", points);
  const cli::Answer answer = run();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("2 points are NaN or infinite"));
  EXPECT_EQ(cli::timeless_result(folder_ / "out/room").at("scans").at(5).at("nonfinite_points"), 2);
  const auto labels = read_labels(folder_ / "out/room/labels/000005.label", points.size());
  EXPECT_EQ(labels[0], kStaticLabel);
  EXPECT_EQ(labels[1], kStaticLabel);
}

TEST_F(SpoiledRun, CountsPointsFartherThanAnySensorSees) {
  const fs::path scan = folder_ / "room/velodyne/000004.bin";
  std::vector<Point> points = read_bin(scan);
  points[0].x = 3e38F;
  points[1].y = -2e6F;
  write_bin(scan, points);
  const cli::Answer answer = run();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("2 points are NaN or infinite"));
  EXPECT_THAT(answer.out, HasSubstr("more than 1000 km away"));
}

TEST_F(SpoiledRun, NamesTheScanWhoseVoxelsWouldOverflow) {
  ASSERT_EQ(run().exit_code, 0);
  const auto before = cli::contents(folder_ / "out");
  write_bin(folder_ / "room/velodyne/000002.bin",
            std::vector<Point>(cli::kPointsPerScan, Point{9e5F, 0.0F, 0.0F, 0.0F}));
  const cli::Answer answer = cli::run(
      {"run", (folder_ / "room").string(), "--out", (folder_ / "out").string(), "--overwrite"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("000002.bin: "));
  EXPECT_EQ(cli::contents(folder_ / "out"), before);
}

TEST_F(SpoiledRun, WritesAnEmptyLabelFileForAnEmptyScan) {
  fs::resize_file(folder_ / "room/velodyne/000004.bin", 0);
  fs::resize_file(folder_ / "room/labels/000004.label", 0);
  const cli::Answer answer = run();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(fs::file_size(folder_ / "out/room/labels/000004.label"), 0U);
}

TEST_F(SpoiledRun, ReportsAnUnknownLabelIdByTheProtocolsRule) {
  auto truth = read_labels(folder_ / "room/labels/000005.label", cli::kPointsPerScan);
  truth[7] = 2;
  write_labels(folder_ / "room/labels/000005.label", truth);
  const cli::Answer answer = run();
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("1 point has a label id that protocol semantickitti-mos"));
  EXPECT_EQ(cli::timeless_result(folder_ / "out/room").at("scans").at(5).at("unknown_ids"), 1);
}

class SpoiledDoals : public testing::Test {
 protected:
  SpoiledDoals() {
    const fs::path sequence = folder_ / "station/sequence_1";
    cli::write_small_sequence(sequence, kScans);
    fs::remove_all(sequence / "labels");
    fs::remove(sequence / "calib.txt");
    write_file_atomic(sequence / "times.txt", "0.5\n0.6\n0.7\n0.8\n0.9\n1.0\n");
  }
  cli::Answer run_with(const std::string& indices) const {
    write_file_atomic(folder_ / "station/sequence_1/indices.csv", indices);
    return cli::run({"run", folder_.path().string(), "--dataset", "doals", "--out",
                     (folder_ / "out").string()});
  }

  TempFolder folder_;
};

TEST_F(SpoiledDoals, RefusesIndicesThatDoNotFitTheScans) {
  const cli::Answer fits = run_with("900000000,1,2,3\n");
  ASSERT_EQ(fits.exit_code, 0) << fits.err;
  EXPECT_THAT(fits.out, HasSubstr("station/sequence_1"));
  fs::remove_all(folder_ / "out");
  for (const char* indices :
       {"900000000,8640\n", "900000001,1\n", "900000000,-1\n", "900000000,x\n", "-900000000,1\n"}) {
    const cli::Answer answer = run_with(indices);
    EXPECT_EQ(answer.exit_code, 3) << indices << answer.err;
    EXPECT_THAT(answer.err, HasSubstr("indices.csv")) << indices;
    EXPECT_FALSE(fs::exists(folder_ / "out/station")) << indices;
  }
}

class BadOutput : public testing::Test {
 protected:
  BadOutput() { cli::write_small_sequence(folder_ / "room", kScans); }
  std::vector<std::string> command() const {
    return {"run", (folder_ / "room").string(), "--out", (folder_ / "out").string()};
  }

  TempFolder folder_;
};

TEST_F(BadOutput, ThatIsAFileIsRefused) {
  folder_.write("out", "in the way");
  const cli::Answer answer = cli::run(command());
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("out/room: cannot be listed (Not a directory)"));
  EXPECT_EQ(read_file(folder_ / "out"), "in the way");
}

TEST_F(BadOutput, ThatIsFullLeavesNothingHalfWritten) {
  const auto full_after_4_kib = [] {
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const cli::Answer answer = cli::run(command(), full_after_4_kib);
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("000000.label: cannot be written"));
  EXPECT_TRUE(!fs::exists(folder_ / "out") || fs::is_empty(folder_ / "out"));
}

}  // namespace
}  // namespace mosbench
