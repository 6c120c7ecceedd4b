#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/layouts/dataset.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

void make(const std::vector<std::string>& words) {
  const cli::Answer answer = cli::run(words);
  ASSERT_EQ(answer.exit_code, 0) << words.front() << ": " << answer.err;
}

/// What a data set says of its sequences: "simulated", "disturbed", both or "".
std::multiset<std::string> marks_below(const fs::path& root) {
  std::multiset<std::string> marks;
  for (const auto& sequence : open_dataset(root, {}).sequences) {
    const DataMark& mark = sequence->mark();
    marks.insert(std::string(mark.simulated ? "simulated" : "") +
                 (mark.disturbed.empty() ? "" : "disturbed"));
  }
  return marks;
}

TEST(DataMarks, AreOfEachSequenceInEveryLayout) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "clean", 6);
  make({"convert", folder / "clean", "--perturb", "range_noise_m=0.02,seed=3", "--layout",
        "semantickitti", "--out", folder / "changed"});
  for (const char* seed : {"1", "2"}) {
    make({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "6", "--seed",
          seed, "--out", folder / seed});
  }
  const fs::path set = folder / "set/sequences";
  fs::create_directories(set);
  fs::rename(folder / "clean", set / "00");
  fs::rename(folder / "changed/sequences/clean", set / "01");
  fs::rename(folder / "1/sequences/08", set / "02");
  fs::rename(folder / "2/sequences/08", set / "03");
  const std::multiset<std::string> expected = {"", "disturbed", "simulated", "simulated"};
  ASSERT_EQ(marks_below(folder / "set"), expected);
  for (const char* layout :
       {"doals", "doals-bag", "sipailou", "helimos", "semantickitti", "opensceneflow", "nuscenes",
        "helipr", "kitti-raw", "kitti-tracking", "ros2-mcap", "ros2-db3"}) {
    if (std::string_view(layout) == "opensceneflow" && !has_hdf5()) continue;
    const fs::path out = folder / layout;
    make({"convert", folder / "set", "--layout", layout, "--out", out});
    EXPECT_EQ(marks_below(out), expected) << layout;
  }
  if (!has_hdf5()) return;
  // A file alone has its mark with it.
  fs::create_directories(folder / "alone");
  for (const char* name : {"01.h5", "02.h5"}) {
    fs::rename(folder / "opensceneflow" / name, folder / "alone" / name);
  }
  EXPECT_EQ(marks_below(folder / "alone"), (std::multiset<std::string>{"disturbed", "simulated"}));
  make({"simulate", "--layout", "opensceneflow", "--scene", "room", "--scans", "6", "--seed", "1",
        "--out", folder / "flow"});
  // Nor is a recorded one simulated that lies beside it.
  fs::rename(folder / "opensceneflow/00.h5", folder / "flow/00.h5");
  EXPECT_EQ(marks_below(folder / "flow"), (std::multiset<std::string>{"", "simulated"}));
  fs::rename(folder / "flow/room.h5", folder / "room.h5");
  EXPECT_EQ(marks_below(folder / "room.h5"), std::multiset<std::string>{"simulated"});
}

}  // namespace
}  // namespace mosbench
