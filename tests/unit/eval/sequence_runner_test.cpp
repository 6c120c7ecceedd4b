#include "eval/engine/sequence_runner.hpp"

#include <gtest/gtest.h>

#include "datasets/text/errors.hpp"
#include "eval/protocols/protocol.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kPointsPerScan = 200'000;

/// Six labelled scans of one wall, of which the last cannot be read.
class BrokenSequence : public Sequence {
 public:
  BrokenSequence() {
    mutable_recording().name = SequenceName("broken", "broken");
    for (int k = 0; k < 6; ++k) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = std::to_string(k);
      entry.points = kPointsPerScan;
      entry.has_truth = true;
    }
  }
  void read(std::size_t scan_index, Frame& frame) const override {
    if (scan_index + 1 == size()) throw DataError("last.bin", "is broken", "a scan");
    describe(scan_index, frame);
    frame.points.assign(kPointsPerScan, Point{2, 1, 0, 0});
    add_truth(scan_index, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t) const override {
    return std::vector<std::uint32_t>(kPointsPerScan, kStaticLabel);
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

/// Returns fewer labels than points, or none at all.
class BrokenMethod : public Method {
 public:
  explicit BrokenMethod(bool silent) : silent_(silent) {}
  using Method::push;
  std::unique_ptr<Observed> observe(std::span<const Point>, const Pose&,
                                    const RayOrigins&) override {
    return std::make_unique<Observed>();
  }
  std::vector<LabelledScan> push(std::unique_ptr<Observed>) override {
    if (silent_) return {};
    LabelledScan scan;
    scan.labels.assign(3, kStaticLabel);
    return {scan};
  }

 private:
  bool silent_;
};

/// Two scans of one point.
class TwoScans : public Sequence {
 public:
  TwoScans() {
    mutable_recording().name = SequenceName("two", "two");
    for (const char* stem : {"a", "b"}) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = stem;
      entry.points = 1;
    }
  }
  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    frame.points.assign(1, Point{2, 1, 0, 0});
  }
  std::vector<std::uint32_t> read_truth(std::size_t) const override { return {}; }
};

TEST(SequenceRunner, RefusesAMethodThatLabelsOtherThanItWasGiven) {
  MethodKind kind = methods().front();
  kind.name = "broken";
  RunSettings settings;
  settings.method = &kind;
  settings.protocol = &protocol_named("mapmos");
  const TempFolder folder;
  kind.make = [](const Settings&, const RunContext&) -> std::unique_ptr<Method> {
    return std::make_unique<BrokenMethod>(false);
  };
  EXPECT_EQ(
      message_of<std::logic_error>([&] { run_sequence(TwoScans(), settings, folder.path()); }),
      "method broken has 3 labels, 0 scores, 0 reasons and 0 objects for the 1 points of scan 0");
  kind.make = [](const Settings&, const RunContext&) -> std::unique_ptr<Method> {
    return std::make_unique<BrokenMethod>(true);
  };
  EXPECT_EQ(
      message_of<std::logic_error>([&] { run_sequence(TwoScans(), settings, folder.path()); }),
      "method broken leaves 2 scans without labels");
}

/// Gives labels and scores, but says never why.
class ReasonlessMethod : public BrokenMethod {
 public:
  ReasonlessMethod() : BrokenMethod(false) {}
  using Method::push;
  std::vector<LabelledScan> push(std::unique_ptr<Observed>) override {
    LabelledScan scan;
    scan.scan_index = pushed_++;
    scan.labels.assign(1, kStaticLabel);
    scan.scores.assign(1, 0.0F);
    return {scan};
  }

 private:
  std::size_t pushed_ = 0;
};

TEST(SequenceRunner, WantsReasonsWithTheScoresOfAMethodThatGivesSome) {
  MethodKind kind = methods().front();
  kind.name = "broken";
  kind.make = [](const Settings&, const RunContext&) -> std::unique_ptr<Method> {
    return std::make_unique<ReasonlessMethod>();
  };
  RunSettings settings;
  settings.method = &kind;
  settings.protocol = &protocol_named("mapmos");
  settings.keeps_scores = true;
  const TempFolder folder;
  run_sequence(TwoScans(), settings, folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder / "reasons"));
  kind.gives_reasons = true;
  EXPECT_EQ(
      message_of<std::logic_error>([&] { run_sequence(TwoScans(), settings, folder.path()); }),
      "method broken has 1 labels, 1 scores, 0 reasons and 0 objects for the 1 points of scan 0");
}

}  // namespace
}  // namespace mosbench
