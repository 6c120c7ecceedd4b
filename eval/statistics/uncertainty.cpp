#include "eval/statistics/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "eval/statistics/long_run_variance.hpp"
#include "eval/statistics/neighbour_correlation.hpp"

namespace mosbench {
namespace {

using Series = std::vector<double>;

// Chosen by bench/interval_coverage.cpp, whose table is in docs/history/coverage.md.

/// Scans in a row are independent when the correlation of neighbours is surely below: with a
/// probability of 95 %.
constexpr double kSurely = 1.645;
constexpr double kHardlyAlike = 0.25;
/// Scans that are far apart are not independent when their correlation is surely above 0.
constexpr double kSurelyAlike = 2.0;
/// Fewer scans that count as much as others do tell nothing.
constexpr double kFewestThatCount = 6.0;
/// A series of fewer values has no correlation.
constexpr std::size_t kFewestInSequence = 4;

std::vector<Series> all_of(std::span<const ScanErrors> sequences, Series ScanErrors::*series) {
  std::vector<Series> all;
  for (const ScanErrors& sequence : sequences) all.push_back(sequence.*series);
  return all;
}

std::string too_few_scans(std::size_t scans) {
  return fmt::format("{} scans, expected at least {} in a row, or {} that are 10 s apart", scans,
                     kFewestScans, kFewestFarScans);
}

/// Returns the larger correlation of neighbours: of errors, or of moving points. The latter shows
/// how long objects stay in view if other errors hide it.
Correlation memory_of(std::span<const ScanErrors> sequences) {
  const Correlation of_errors = neighbour_correlation(all_of(sequences, &ScanErrors::error));
  const Correlation of_objects = neighbour_correlation(all_of(sequences, &ScanErrors::moving));
  return of_errors.value < of_objects.value ? of_objects : of_errors;
}

/// Returns how many scans of equal weight would tell as much (Kish 1965).
double scans_that_count(std::span<const ScanErrors> sequences) {
  double sum = 0.0, squares = 0.0;
  for (const ScanErrors& sequence : sequences) {
    for (const double weight : sequence.weight) {
      sum += weight;
      squares += weight * weight;
    }
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

SumUncertainty of_independent(std::span<const ScanErrors> sequences) {
  SumUncertainty found;
  double variance = 0.0;
  for (const ScanErrors& sequence : sequences) {
    const auto scans = static_cast<double>(sequence.error.size());
    variance += scans / (scans - 1.0) * squared_deviations(sequence.error);
  }
  found.standard_error = std::sqrt(variance);
  found.freedom =
      std::max(1.0, scans_that_count(sequences) - static_cast<double>(sequences.size()));
  return found;
}

/// Returns why nothing can be told from scans of any correlation; empty when there is no reason.
std::string too_few(std::span<const ScanErrors> sequences) {
  std::size_t scans = 0, shortest = kFewestInSequence;
  for (const ScanErrors& sequence : sequences) {
    scans += sequence.error.size();
    shortest = std::min(shortest, sequence.error.size());
  }
  if (scans < kFewestFarScans) return too_few_scans(scans);
  if (shortest < kFewestInSequence) {
    return fmt::format("a sequence of {} scans, expected at least {}", shortest, kFewestInSequence);
  }
  const double counting = scans_that_count(sequences);
  if (counting >= kFewestThatCount) return "";
  return fmt::format(
      "{:.0f} of {} scans hold nearly all points that count, expected at least {:.0f}",
      std::ceil(counting), scans, kFewestThatCount);
}

}  // namespace

SumUncertainty uncertainty_of_sum(std::span<const ScanErrors> sequences, Spacing spacing) {
  if (const std::string why = too_few(sequences); !why.empty()) return {0.0, 0.0, why};
  std::size_t scans = 0;
  for (const ScanErrors& sequence : sequences) scans += sequence.error.size();
  const bool few = scans < kFewestScans;
  const Correlation memory = memory_of(sequences);
  const bool independent = spacing == Spacing::kFar ? memory.bound(-kSurelyAlike) < 0.0
                                                    : few && memory.bound(kSurely) < kHardlyAlike;
  if (independent) return of_independent(sequences);
  if (few) {
    return {0.0, 0.0,
            spacing == Spacing::kNear
                ? too_few_scans(scans)
                : fmt::format("{} scans that are alike, though far apart, expected at least {}",
                              scans, kFewestScans)};
  }
  return long_run_uncertainty(all_of(sequences, &ScanErrors::error), memory);
}

}  // namespace mosbench
