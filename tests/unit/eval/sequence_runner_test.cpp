#include "eval/runs/sequence_runner.hpp"

#include <gtest/gtest.h>

#include "datasets/files/errors.hpp"
#include "eval/protocols/protocol.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kPoints = 200'000;

/// Six labelled scans of one wall, of which the last cannot be read.
class BrokenSequence : public Sequence {
 public:
  BrokenSequence() {
    mutable_recording().name = "broken";
    for (int k = 0; k < 6; ++k) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = std::to_string(k);
      entry.points = kPoints;
      entry.has_truth = true;
    }
  }
  void read(std::size_t scan_index, Frame& frame) const override {
    if (scan_index + 1 == size()) throw DataError("last.bin", "is broken", "a scan");
    describe(scan_index, frame);
    frame.points.assign(kPoints, Point{2, 1, 0, 0});
    add_truth(scan_index, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t) const override {
    return std::vector<std::uint32_t>(kPoints, kStaticLabel);
  }
};

TEST(SequenceRunner, EndsWithTheErrorOfAScanThatCannotBeRead) {
  for (const unsigned threads : {1U, 2U}) {
    const TempFolder folder;
    RunSettings settings;
    settings.method = &methods().front();
    settings.method_settings = settings.method->defaults;
    settings.protocol = &protocol_named("mapmos");
    settings.range = settings.protocol->default_range;
    settings.threads = threads;
    const std::string error =
        message_of<DataError>([&] { run_sequence(BrokenSequence(), settings, folder.path()); });
    EXPECT_NE(error.find("last.bin"), std::string::npos) << error;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "labels/3.label"));
  }
}

}  // namespace
}  // namespace mosbench
