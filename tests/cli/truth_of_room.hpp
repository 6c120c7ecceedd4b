#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {

/// Tracks that were proposed of a box that crosses a room, copied for each test.
class TruthOfRoom : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new TempFolder;
    cli::write_small_sequence(*made_ / "room", kScans);
    std::filesystem::rename(*made_ / "room/labels", *made_ / "true_labels");
    proposed_ = new cli::Answer(cli::run(
        {"truth", "propose", (*made_ / "room").string(), "-o", (*made_ / "truth").string()}));
  }
  static void TearDownTestSuite() {
    delete proposed_;
    delete made_;
  }
  void SetUp() override {
    ASSERT_EQ(proposed_->exit_code, 0) << proposed_->err;
    std::filesystem::copy(*made_ / "truth", folder_ / "truth",
                          std::filesystem::copy_options::recursive);
  }

  static constexpr std::size_t kScans = 26;
  std::string truth() const { return (folder_ / "truth").string(); }
  std::string room() const { return (*made_ / "room").string(); }

  nlohmann::json tracks() const {
    return nlohmann::json::parse(read_file(folder_ / "truth/tracks.json")).at("tracks");
  }
  /// The track of the box that crosses the room.
  std::string box() const {
    const nlohmann::json all = tracks();
    const auto most = std::ranges::max_element(
        all, {}, [](const nlohmann::json& track) { return track.at("points").get<int>(); });
    return "room/" + std::to_string(most->at("number").get<int>());
  }
  void decide(const std::string& track, const std::string& decided) const {
    write_file_atomic(folder_ / "truth/decisions.json",
                      R"({"format": 1, "decisions": [{"track": ")" + track + R"(", "decided": ")" +
                          decided + "\"}]}");
  }
  cli::Answer write() const {
    return cli::run({"truth", "write", truth(), "--out", (folder_ / "own").string()});
  }
  std::vector<std::uint32_t> written(std::size_t scan) const {
    return read_labels(folder_ / "own/room/labels" / (cli::stem(scan) + ".label"),
                       cli::kPointsPerScan);
  }
  /// Returns how many points of the box have this label.
  std::size_t of_box(std::uint32_t label) const {
    std::size_t points = 0;
    for (std::size_t k = 0; k < kScans; ++k) {
      const auto labels = written(k);
      const auto truth =
          read_labels(*made_ / "true_labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
      for (std::size_t i = 0; i < labels.size(); ++i) {
        if (truth[i] == kMovingLabel && labels[i] == label) ++points;
      }
    }
    return points;
  }

  static inline TempFolder* made_ = nullptr;
  static inline cli::Answer* proposed_ = nullptr;
  TempFolder folder_;
};

}  // namespace mosbench
