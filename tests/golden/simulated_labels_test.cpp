#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "datasets/disk/files.hpp"
#include "tests/cli/program.hpp"

// The labels of the authors' program on simulated sequences; tests/golden/simulated/README.md says
// how they were made.
namespace mosbench {
namespace {

struct SimulatedCase {
  const char* name;
  const char* scene;
  const char* scans;
  const char* settings;
  const char* labels_sha256;
};

void PrintTo(const SimulatedCase& simulated, std::ostream* out) { *out << simulated.name; }

/// SHA-256 of all label files of a folder, one after the other in the order of their names.
std::string sha256_of_labels(const std::filesystem::path& folder) {
  const std::string command = "cat '" + folder.string() + "'/*.label | sha256sum";
  FILE* pipe = popen(command.c_str(), "r");
  std::string digits;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF && c != ' ';) digits += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0);
  return digits;
}

class SimulatedLabels : public testing::TestWithParam<SimulatedCase> {};

TEST_P(SimulatedLabels, EqualThoseOfTheAuthorsProgram) {
  const SimulatedCase& simulated = GetParam();
  const TempFolder folder;
  const auto drive = folder / "sequences/08";
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", simulated.scene,
                      "--scans", simulated.scans, "--seed", "1", "--out", folder.path().string()})
                .exit_code,
            0);
  const auto poses = std::filesystem::path(MOSBENCH_SOURCE_DIR) / "tests/golden/simulated" /
                     (std::string(simulated.name) + ".poses.txt");
  write_file_atomic(drive / "poses.txt", read_file(poses));
  write_file_atomic(drive / "calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  const cli::Answer answer = cli::run({"run", drive.string(), "--dataset", "semantickitti", "--set",
                                       simulated.settings, "--out", (folder / "out").string()});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(sha256_of_labels(folder / "out/08/labels"), simulated.labels_sha256);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SimulatedLabels,
    testing::Values(
        SimulatedCase{"campus_0", "campus", "60",
                      "voxel_size_m=0.25,min_range_m=3,max_range_m=50,delay_scans=0",
                      "2678093a024807a52297e1ebd10f1a2a930230c4edb27a8ede36b3b978270bb5"},
        SimulatedCase{"street_0", "street", "40",
                      "voxel_size_m=0.25,min_range_m=1.5,max_range_m=50,delay_scans=0",
                      "34f16e4a96772d1e57fbf01a09e8fcc384a515f5ccaa3b982dff174d063a04a5"},
        SimulatedCase{"highway_10", "highway", "30",
                      "voxel_size_m=0.25,min_range_m=1.5,max_range_m=50,delay_scans=10",
                      "9dcb676e458b47e702c2d1cadea18399d533b8d386a6a592a23fc9fb11ab9547"},
        SimulatedCase{"mall_0", "mall", "40",
                      "voxel_size_m=0.2,min_range_m=0.5,max_range_m=20,delay_scans=0",
                      "b7ed807d670debb34646d73e6935dd61c4c7676a15b550e80fa8d014e9997b97"}),
    [](const auto& simulated) { return std::string(simulated.param.name); });

}  // namespace
}  // namespace mosbench
