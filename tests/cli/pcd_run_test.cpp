#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/shared_folder.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

TEST(RunOnPcd, GivesTheLabelsOfTheBinFilesOfTheSameRealScans) {
  const fs::path shared = shared_folder();
  if (!fs::exists(shared / "real/pcd")) GTEST_SKIP() << shared << " holds no real scans";
  const TempFolder folder;
  std::string poses;
  for (int i = 0; i < 5; ++i) {
    // The car's 0.35 m per scan, as the transforms of the same drive tell.
    poses += "1 0 0 " + std::to_string(0.35 * i) + " 0 1 0 0 0 0 1 0\n";
    for (const char* kind : {"bin", "pcd"}) {
      const std::string name = "000000000" + std::to_string(i) + "." + kind;
      fs::create_directories(folder / kind / "velodyne");
      fs::copy_file(shared / "real/pcd" / name, folder / kind / "velodyne" / name);
    }
  }
  std::size_t moving = 0;
  for (const char* kind : {"bin", "pcd"}) {
    write_file_atomic(folder / kind / "poses.txt", poses);
    const cli::Answer answer =
        cli::run({"run", (folder / kind).string(), "--out", (folder / "out").string(), "--set",
                  "voxel_size_m=0.25", "max_range_m=30"});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  for (int i = 0; i < 5; ++i) {
    const std::string name = "labels/000000000" + std::to_string(i) + ".label";
    const std::string of_bin = read_file(folder / "out/bin" / name);
    const std::string of_pcd = read_file(folder / "out/pcd" / name);
    // Each .pcd ends with one point (0,0,0) more, which never moves.
    EXPECT_EQ(of_pcd, of_bin + std::string("\x09\0\0\0", 4)) << name;
    for (std::size_t at = 0; at < of_bin.size(); at += 4) moving += of_bin[at] != '\x09';
  }
  EXPECT_GT(moving, 0U);
}

}  // namespace
}  // namespace mosbench
