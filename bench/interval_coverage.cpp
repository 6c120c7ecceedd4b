// Measures how often intervals hold the truth, and how often the paired test calls equal runs
// different, on counts of simulated scans whose true IoU is known. Prints the table of
// docs/history/coverage.md: mosbench_interval_coverage [SAMPLES_PER_ROW [FIRST_SEED]]. Constants
// were chosen on the samples of the seeds 1 to 4000: judge them on others.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include "eval/statistics/intervals.hpp"

namespace {

using namespace mosbench;

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double uniform() { return (static_cast<double>(bits_() >> 11U) + 0.5) * 0x1p-53; }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Number of scans until an event that has this probability in each.
  std::size_t scans_until(double probability) {
    return 1 + static_cast<std::size_t>(std::log(uniform()) / std::log1p(-probability));
  }

 private:
  std::mt19937_64 bits_;
};

struct Runs {
  SequenceCounts first, second;
};

std::uint64_t points(double number) { return static_cast<std::uint64_t>(std::llround(number)); }

Confusion scan(double moving, double found, double false_positives) {
  Confusion counts;
  counts.tp = points(moving * found);
  counts.fn = points(moving * (1.0 - found));
  counts.fp = points(false_positives);
  return counts;
}

std::vector<double> autoregressive(Random& random, std::size_t scans, double memory) {
  std::vector<double> series = {random.normal()};
  while (series.size() < scans) {
    series.push_back(memory * series.back() + std::sqrt(1.0 - memory * memory) * random.normal());
  }
  return series;
}

/// Moving points, recall and false positives wander as autoregressive processes; 70 % of the
/// variance of recall and false positives is common to both runs.
Runs wandering(Random& random, std::size_t scans, double memory) {
  const auto series = [&] { return autoregressive(random, scans, memory); };
  const auto moving = series();
  const auto recall = series(), recall_of_first = series(), recall_of_second = series();
  const auto false_positives = series(), of_first = series(), of_second = series();
  const double common = std::sqrt(0.7);
  const double own = std::sqrt(0.3);
  Runs runs;
  for (std::size_t k = 0; k < scans; ++k) {
    const auto run = [&](double recall_of_run, double false_positives_of_run) {
      const double found = std::clamp(0.65 + 0.12 * recall_of_run, 0.0, 1.0);
      return scan(std::exp(6.0 + 0.3 * moving[k]), found,
                  std::exp(4.0 + 0.4 * false_positives_of_run));
    };
    runs.first.push_back(run(common * recall[k] + own * recall_of_first[k],
                             common * false_positives[k] + own * of_first[k]));
    runs.second.push_back(run(common * recall[k] + own * recall_of_second[k],
                              common * false_positives[k] + own * of_second[k]));
  }
  return runs;
}

/// Adds an object that is seen in scans [from, to), of which each run finds its own share.
void add_object(Random& random, std::size_t from, std::size_t to, Runs& runs) {
  const double size = std::exp(4.0 + 0.7 * random.normal());
  const double found = std::clamp(0.7 + 0.2 * random.normal(), 0.0, 1.0);
  const double by_first = std::clamp(found + 0.1 * random.normal(), 0.0, 1.0);
  const double by_second = std::clamp(found + 0.1 * random.normal(), 0.0, 1.0);
  for (std::size_t k = from; k < to; ++k) {
    const double moving = size * std::exp(0.2 * random.normal());
    runs.first[k] += scan(moving, by_first, 0.0);
    runs.second[k] += scan(moving, by_second, 0.0);
  }
}

/// Objects appear in 14 % of the scans and stay for `seen_scans` in the mean (geometric).
Runs objects(Random& random, std::size_t scans, double seen_scans) {
  const auto before = static_cast<std::size_t>(12.0 * seen_scans);
  Runs runs{SequenceCounts(before + scans), SequenceCounts(before + scans)};
  for (std::size_t k = 0; k < before + scans; ++k) {
    const double noise = std::exp(2.0 + 0.5 * random.normal());
    runs.first[k] += scan(0.0, 0.0, noise * std::exp(0.3 * random.normal()));
    runs.second[k] += scan(0.0, 0.0, noise * std::exp(0.3 * random.normal()));
    if (random.uniform() > 0.14) continue;
    const std::size_t end = k + random.scans_until(1.0 / seen_scans);
    add_object(random, k, std::min(end, before + scans), runs);
  }
  for (SequenceCounts* run : {&runs.first, &runs.second})
    run->erase(run->begin(), run->begin() + static_cast<std::ptrdiff_t>(before));
  return runs;
}

/// Scans of DOALS that are judged are 72 to 200 scans apart.
constexpr std::size_t kFarScans = 100;

struct Model {
  const char* name;
  Runs (*simulate)(Random&, std::size_t, double);
  double memory;
};

/// IoU of very many scans.
double true_iou(const Model& model) {
  Random random(1);
  Confusion all;
  for (int part = 0; part < 40; ++part) {
    const Runs runs = model.simulate(random, 50000, model.memory);
    for (const Confusion& counts : runs.first) all += counts;
    for (const Confusion& counts : runs.second) all += counts;
  }
  return metrics_of(all)[0];
}

SequenceCounts every(std::size_t apart_scans, const SequenceCounts& scans) {
  SequenceCounts picked;
  for (std::size_t k = 0; k < scans.size(); k += apart_scans) picked.push_back(scans[k]);
  return picked;
}

/// How many of the samples had an interval, and how many of those were wrong.
struct Share {
  int given = 0;
  int wrong = 0;
  std::string text(int samples, bool as_coverage) const {
    const int percent_given = static_cast<int>(std::lround(100.0 * given / samples));
    if (given < samples / 20) return fmt::format("{} % | none", percent_given);
    const double wrong_percent = 100.0 * wrong / given;
    return fmt::format("{} % | {:.1f} %", percent_given,
                       as_coverage ? 100.0 - wrong_percent : wrong_percent);
  }
  void count(const Estimate& metric, double truth) {
    if (!metric.interval) return;
    ++given;
    if (truth < metric.interval->low || truth > metric.interval->high) ++wrong;
  }
};

/// Scans that are judged in each sample.
struct Judged {
  std::size_t sequences = 1, scans = 0;
  std::size_t apart_scans = 1;  ///< more than 1: they are known to be far apart
  std::string text() const {
    const std::string count =
        sequences == 1 ? fmt::format("{}", scans) : fmt::format("{} x {}", sequences, scans);
    return apart_scans == 1 ? count : fmt::format("{}, {} apart", count, apart_scans);
  }
};

/// Sample i of a row has the seed first_seed + i.
struct Samples {
  int count = 0;
  std::uint64_t first_seed = 1;
};

void print_row(const Model& model, double truth, const Judged& judged, const Samples& samples) {
  const Protocol& protocol = protocol_named("semantickitti-mos");
  const Spacing spacing = judged.apart_scans > 1 ? Spacing::kFar : Spacing::kNear;
  Share interval, test;
  for (int sample = 0; sample < samples.count; ++sample) {
    Random random(samples.first_seed + static_cast<std::uint64_t>(sample));
    std::vector<SequenceCounts> first, second;
    for (std::size_t s = 0; s < judged.sequences; ++s) {
      const Runs runs = model.simulate(random, judged.scans * judged.apart_scans, model.memory);
      first.push_back(every(judged.apart_scans, runs.first));
      second.push_back(every(judged.apart_scans, runs.second));
    }
    interval.count(estimate(protocol, first, spacing)[Metric::kIou], truth);
    test.count(paired_difference(protocol, first, second, spacing)[Metric::kIou], 0.0);
  }
  fmt::print("| {} | {} | {} | {} |\n", model.name, judged.text(),
             interval.text(samples.count, true), test.text(samples.count, false));
}

}  // namespace

int main(int argc, char** argv) {
  const Samples samples = {argc > 1 ? std::atoi(argv[1]) : 4000,
                           argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1};
  const Samples half = {samples.count / 2, samples.first_seed};
  const std::vector<Model> models = {
      {"independent scans", wandering, 0.0},   {"AR(1) 0.5", wandering, 0.5},
      {"AR(1) 0.8", wandering, 0.8},           {"AR(1) 0.95", wandering, 0.95},
      {"objects seen 3 scans", objects, 3.0},  {"objects seen 10 scans", objects, 10.0},
      {"objects seen 30 scans", objects, 30.0}};
  fmt::print(
      "| model | scans | interval given | coverage | test given | size |\n"
      "|---|---|---|---|---|---|\n");
  for (const Model& model : models) {
    const double truth = true_iou(model);
    for (const std::size_t scans : {20U, 60U, 150U, 300U, 1000U}) {
      print_row(model, truth, {1, scans}, scans < 1000 ? samples : half);
    }
    print_row(model, truth, {10, 40}, samples);
    for (const std::size_t scans : {20U, 60U}) {
      print_row(model, truth, {1, scans, kFarScans}, half);
    }
    print_row(model, truth, {2, 10, kFarScans}, half);
  }
  return 0;
}
