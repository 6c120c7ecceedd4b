#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/layouts/layout.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

std::vector<std::string> sequences_in(const std::filesystem::path& path) {
  std::vector<std::string> names;
  for (const SequenceFolder& sequence : layout_of(DatasetKind::kMdetector).list(path)) {
    names.push_back(sequence.name);
  }
  return names;
}

// Every set of the download numbers its sequences from 0000 on.
TEST(MdetectorLayout, NamesSequencesByTheirSet) {
  const TempFolder folder;
  for (const char* sequence :
       {"kitti/sequences/0000", "kitti/sequences/0001", "waymo/sequences/0000"}) {
    std::filesystem::create_directories(folder / "M-detector" / sequence / "velodyne");
  }
  using Names = std::vector<std::string>;
  EXPECT_EQ(sequences_in(folder / "M-detector"), (Names{"KITTI/0000", "KITTI/0001", "Waymo/0000"}));
  EXPECT_EQ(sequences_in(folder / "M-detector/waymo"), (Names{"Waymo/0000"}));
  EXPECT_EQ(sequences_in(folder / "M-detector/kitti/sequences/0001"), (Names{"KITTI/0001"}));
  // A set that is one sequence, and folders of other names, keep theirs.
  std::filesystem::create_directories(folder / "mine/Avia/velodyne");
  EXPECT_EQ(sequences_in(folder / "mine"), (Names{"Avia"}));
}

}  // namespace
}  // namespace mosbench
