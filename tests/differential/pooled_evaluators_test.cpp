// Slow twins of the published programs that pool points over scans, written line by line after
// their sources, compared bit by bit on random labels.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "eval/protocols/metrics.hpp"
#include "tests/random_scans.hpp"

namespace mosbench {
namespace {

std::string printf_string(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::vector<RandomScan> random_scans(unsigned seed, std::size_t points,
                                     std::span<const std::uint32_t> ids) {
  std::mt19937 random(seed);
  std::vector<RandomScan> scans;
  for (int k = 0; k < 12; ++k) scans.push_back(random_scan(random, points, ids));
  return scans;
}

std::vector<Confusion> score_all(const Protocol& protocol, const std::vector<RandomScan>& scans) {
  std::vector<Confusion> counts;
  for (const RandomScan& scan : scans) {
    counts.push_back(score_scan(protocol, scan.truth, scan.prediction, scan.points));
  }
  return counts;
}

/// semantic-kitti-api's evaluate_mos.py with np_ioueval.py.
class EvaluateMosTwin {
 public:
  EvaluateMosTwin(const std::map<int, int>& learning_map, std::size_t classes, int ignored,
                  std::size_t moving)
      : lut_(static_cast<std::size_t>(learning_map.rbegin()->first) + 100, 0),
        confusion_(classes, std::vector<std::int64_t>(classes, 0)),
        ignored_(ignored),
        moving_(moving) {
    for (const auto& [id, learned] : learning_map) lut_[static_cast<std::size_t>(id)] = learned;
  }
  void add_batch(const std::vector<std::uint32_t>& prediction,
                 const std::vector<std::uint32_t>& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const int row = lut_.at(prediction[i] & 0xFFFFU);
      const int column = lut_.at(truth[i] & 0xFFFFU);
      ++confusion_[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    }
  }
  void finish() {
    auto clean = confusion_;
    if (ignored_ >= 0) {
      for (auto& row : clean) row[static_cast<std::size_t>(ignored_)] = 0;
    }
    tp = clean[moving_][moving_];
    for (std::size_t other = 0; other < clean.size(); ++other) {
      fp += clean[moving_][other];
      fn += clean[other][moving_];
    }
    fp -= tp;
    fn -= tp;
    iou = static_cast<double>(tp) / (static_cast<double>(tp + fp + fn) + 1e-15);
  }
  std::int64_t tp = 0, fp = 0, fn = 0;
  double iou = 0.0;

 private:
  std::vector<int> lut_;
  std::vector<std::vector<std::int64_t>> confusion_;
  int ignored_;
  std::size_t moving_;
};

std::map<int, int> semantic_kitti_learning_map() {
  std::map<int, int> learned = {{0, 0}, {1, 0}};
  for (const int id : {9,  10, 11, 13, 15, 16, 18, 20, 30, 31, 32, 40, 44,
                       48, 49, 50, 51, 52, 60, 70, 71, 72, 80, 81, 99}) {
    learned[id] = 1;
  }
  for (int id = 251; id <= 259; ++id) learned[id] = 2;
  return learned;
}

void expect_equal(const EvaluateMosTwin& twin, const Protocol& protocol,
                  const std::vector<RandomScan>& scans) {
  const Summary summary = summarize(protocol, score_all(protocol, scans));
  EXPECT_EQ(static_cast<std::int64_t>(summary.pooled.tp), twin.tp);
  EXPECT_EQ(static_cast<std::int64_t>(summary.pooled.fp), twin.fp);
  EXPECT_EQ(static_cast<std::int64_t>(summary.pooled.fn), twin.fn);
  EXPECT_EQ(summary.published_iou, twin.iou);
  EXPECT_EQ(summary.published_text, printf_string("%.3f", twin.iou));
}

TEST(EvaluateMos, GivesTheSameAsItsTwinForSemanticKittiAndHelimos) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 0; id < 359; ++id) ids.push_back(id);
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto scans = random_scans(seed, seed % 9, ids);
    const auto more = random_scans(seed, 700, ids);
    for (const auto& some : {scans, more}) {
      EvaluateMosTwin twin(semantic_kitti_learning_map(), 3, 0, 2);
      for (const RandomScan& scan : some) twin.add_batch(scan.prediction, scan.truth);
      twin.finish();
      for (const char* name : {"semantickitti-mos", "helimos-all", "helimos-test"}) {
        expect_equal(twin, protocol_named(name), some);
      }
    }
  }
}

TEST(EvaluateMos, GivesTheSameAsItsTwinForSipailou) {
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 0; id < 352; id += 3) ids.push_back(id);
  for (const std::uint32_t id : {0U, 9U, 9U, 251U, 251U, 252U}) ids.insert(ids.end(), 20, id);
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto scans = random_scans(seed, seed * 10, ids);
    EvaluateMosTwin twin({{0, 0}, {9, 0}, {251, 1}, {252, 1}}, 2, -1, 1);
    for (const RandomScan& scan : scans) twin.add_batch(scan.prediction, scan.truth);
    twin.finish();
    expect_equal(twin, protocol_named("sipailou"), scans);
  }
}

/// MapMOS: labels -1, 0 and 1, a range mask over both, a 2x2 confusion matrix in float32.
struct MapmosTwin {
  int ignored_up_to;
  double min_range, max_range;
  std::array<std::array<float, 2>, 2> confusion{};

  bool is_masked_in(const Point& point) const {
    const double x = static_cast<double>(point.x);
    const double y = static_cast<double>(point.y);
    const double z = static_cast<double>(point.z);
    const double range = std::sqrt(x * x + y * y + z * z);
    bool mask = max_range > 0 ? range <= max_range : true;
    mask = mask && range >= min_range;
    return mask;
  }
  void add(const RandomScan& scan) {
    std::array<std::array<int, 2>, 2> matrix{};
    for (std::size_t i = 0; i < scan.truth.size(); ++i) {
      if (!is_masked_in(scan.points[i])) continue;
      const int original = static_cast<int>(scan.truth[i] & 0xFFFFU);
      int label = 0;
      if (original <= ignored_up_to) label = -1;
      if (original > 250) label = 1;
      if (label == -1) continue;
      const int predicted = static_cast<int>(scan.prediction[i] & 0xFFFFU) > 250 ? 1 : 0;
      ++matrix[static_cast<std::size_t>(predicted)][static_cast<std::size_t>(label)];
    }
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t column = 0; column < 2; ++column) {
        confusion[row][column] += static_cast<float>(matrix[row][column]);
      }
    }
  }
  float tp() const { return confusion[1][1]; }
  float fp() const { return confusion[1][0] + confusion[1][1] - tp(); }
  float fn() const { return confusion[0][1] + confusion[1][1] - tp(); }
  double iou_percent() const {
    const float iou = tp() / (tp() + fp() + fn() + 1e-15F);
    if (tp() + fn() == 0.0F) return std::nan("");
    return static_cast<double>(iou) * 100.0;
  }
};

TEST(Mapmos, GivesTheSameAsItsTwin) {
  const std::map<std::string_view, int> ignored_up_to = {
      {"mapmos", 1}, {"mapmos-apollo", -1}, {"mapmos-kitti-tracking", 2}, {"mapmos-nuscenes", 1}};
  for (const auto& [name, highest] : ignored_up_to) {
    const Protocol& protocol = protocol_named(name);
    for (unsigned seed = 1; seed <= 40; ++seed) {
      const RangeGate limits = seed % 2 == 0 ? RangeGate{0.0, -1.0} : RangeGate{0.5, 20.0};
      MapmosTwin twin{
          .ignored_up_to = highest, .min_range = limits.min_m, .max_range = limits.max_m};
      std::vector<Confusion> counts;
      for (const RandomScan& scan : random_scans(seed, seed * 10, kAllIds)) {
        twin.add(scan);
        counts.push_back(score_scan(protocol, scan.truth, scan.prediction, scan.points, limits));
      }
      const Summary summary = summarize(protocol, counts);
      EXPECT_EQ(static_cast<float>(summary.pooled.tp), twin.tp());
      EXPECT_EQ(static_cast<float>(summary.pooled.fp), twin.fp());
      EXPECT_EQ(static_cast<float>(summary.pooled.fn), twin.fn());
      EXPECT_EQ(summary.published_iou, twin.iou_percent());
    }
  }
}

/// M-detector's cal_recall_multi.cpp, total counts and "Average iou".
struct MdetectorTwin {
  bool nuscenes, kitti;
  int tp = 0, fp = 0, fn = 0, tn = 0;

  void add(int label, int prediction) {
    label = label & 0xFFFF;
    prediction = prediction & 0xFFFF;
    const bool predicted = prediction >= 251 && prediction < 65535;
    if (kitti && !predicted && prediction != 9) return;
    if (label >= (nuscenes ? 1000 : 251) && label < 65535) {
      ++(predicted ? tp : fn);
    } else if (label < 251) {
      ++(predicted ? fp : tn);
    } else if (nuscenes && label >= 251 && label < 1000) {
      ++tn;
    }
  }
  std::string printed_iou() const {
    std::ostringstream out;
    out << static_cast<float>(tp) / static_cast<float>(tp + fn + fp);
    return out.str();
  }
};

TEST(Mdetector, GivesTheSameAsItsTwin) {
  for (const std::string_view name : {"mdetector", "mdetector-kitti", "mdetector-nuscenes"}) {
    const Protocol& protocol = protocol_named(name);
    for (unsigned seed = 1; seed <= 40; ++seed) {
      const auto scans = random_scans(seed, 5 + seed * 10, kAllIds);
      MdetectorTwin twin{.nuscenes = name == "mdetector-nuscenes",
                         .kitti = name == "mdetector-kitti"};
      for (const RandomScan& scan : scans) {
        for (std::size_t i = 0; i < scan.truth.size(); ++i) {
          twin.add(static_cast<int>(scan.truth[i]), static_cast<int>(scan.prediction[i]));
        }
      }
      const Summary summary = summarize(protocol, score_all(protocol, scans));
      EXPECT_EQ(static_cast<int>(summary.pooled.tp), twin.tp);
      EXPECT_EQ(static_cast<int>(summary.pooled.fp), twin.fp);
      EXPECT_EQ(static_cast<int>(summary.pooled.fn), twin.fn);
      EXPECT_EQ(static_cast<int>(summary.pooled.tn), twin.tn);
      EXPECT_EQ(summary.published_text, twin.printed_iou());
    }
  }
}

}  // namespace
}  // namespace mosbench
