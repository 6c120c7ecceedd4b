#include "eval/runs/sequence_runner.hpp"

#include <gtest/gtest.h>

#include "datasets/files/errors.hpp"
#include "eval/protocols/protocol.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

/// Labelled scans of one wall, of which the last cannot be read.
class BrokenSequence : public Sequence {
 public:
  std::string name() const override { return "broken"; }
  std::size_t size() const override { return 6; }
  std::string stem(std::size_t scan_index) const override { return std::to_string(scan_index); }
  bool has_truth(std::size_t) const override { return true; }
  std::optional<std::filesystem::path> scan_file(std::size_t) const override { return {}; }
  Pose map_from_sensor(std::size_t) const override { return Pose::Identity(); }
  std::optional<std::int64_t> stamp_ns(std::size_t) const override { return {}; }
  std::vector<std::uint32_t> read_truth(std::size_t) const override {
    return std::vector<std::uint32_t>(kPoints, kStaticLabel);
  }
  std::size_t point_count(std::size_t) const override { return kPoints; }
  std::vector<std::filesystem::path> files() const override { return {}; }
  std::vector<std::string> remarks() const override { return {}; }
  ReadingStatement reading() const override { return {}; }

  static constexpr std::size_t kPoints = 200'000;

 private:
  Frame read_frame(std::size_t scan_index, Frame spent) const override {
    if (scan_index + 1 == size()) throw DataError("last.bin", "is broken", "a scan");
    Frame frame;
    frame.stem = stem(scan_index);
    frame.points = std::move(spent.points);
    frame.points.assign(kPoints, Point{2, 1, 0, 0});
    frame.truth = read_truth(scan_index);
    return frame;
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
