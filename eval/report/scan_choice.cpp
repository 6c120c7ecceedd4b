#include "eval/report/scan_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLast = std::numeric_limits<std::size_t>::max();

std::optional<std::size_t> behind(std::string_view prefix, std::string_view word) {
  if (!word.starts_with(prefix)) return std::nullopt;
  return parse_unsigned(word.substr(prefix.size()));
}

std::uint64_t false_points(const ScanRow& row) {
  return row.counts ? row.counts->fp + row.counts->fn : 0;
}

/// Returns 0, n-1, then the middles of ever shorter gaps.
std::vector<std::size_t> spread(std::size_t n) {
  std::vector<std::size_t> order;
  if (n > 0) order.push_back(0);
  if (n > 1) order.push_back(n - 1);
  std::size_t step = 1;
  while (2 * step < n) step *= 2;
  for (; step > 0; step /= 2) {
    for (std::size_t k = step; k + 1 < n; k += 2 * step) order.push_back(k);
  }
  return order;
}

}  // namespace

ScanChoice::Part ScanChoice::parse(const std::string& word) {
  if (word == "auto") return {Part::Kind::kAuto};
  if (word == "all") return {Part::Kind::kRange, 0, kLast};
  if (const auto scan = parse_unsigned(word)) return {Part::Kind::kRange, *scan, *scan};
  if (const auto step = behind("every:", word); step && *step > 0) {
    return {Part::Kind::kEvery, *step};
  }
  if (const auto count = behind("worst:", word)) return {Part::Kind::kWorst, *count};
  const std::size_t dash = word.find('-');
  if (dash != std::string::npos) {
    const auto first = parse_unsigned(std::string_view(word).substr(0, dash));
    const auto last = parse_unsigned(std::string_view(word).substr(dash + 1));
    if (first && last && *first <= *last) return {Part::Kind::kRange, *first, *last};
  }
  throw UsageError(fmt::format(
      "--scans: '{}' is not known, expected auto, all, none, or K, A-B, every:N, worst:N", word));
}

ScanChoice::ScanChoice(const std::string& text) {
  if (text == "none") return;
  std::istringstream words(text + ',');
  for (std::string word; std::getline(words, word, ',');) parts_.push_back(parse(word));
}

std::vector<std::size_t> ScanChoice::wanted(const std::vector<ScanRow>& rows) const {
  std::vector<std::size_t> order;
  std::vector<bool> taken(rows.size(), false);
  const auto take = [&](std::size_t k) {
    if (k >= rows.size() || taken[k]) return;
    taken[k] = true;
    order.push_back(k);
  };
  const auto take_worst = [&](std::size_t count) {
    std::vector<std::size_t> worst = worst_first(rows);
    std::erase_if(worst, [&](std::size_t k) { return !rows[k].counts; });
    for (std::size_t i = 0; i < std::min(count, worst.size()); ++i) take(worst[i]);
  };
  for (const Part& part : parts_) {
    switch (part.kind) {
      case Part::Kind::kAuto:
        take_worst((rows.size() + 9) / 10);
        for (const std::size_t k : spread(rows.size())) take(k);
        break;
      case Part::Kind::kRange:
        for (std::size_t k = part.first; k < rows.size() && k <= part.last; ++k) take(k);
        break;
      case Part::Kind::kEvery:
        for (std::size_t k = 0; k < rows.size(); k += std::min(part.first, rows.size())) take(k);
        break;
      case Part::Kind::kWorst:
        take_worst(part.first);
        break;
    }
  }
  return order;
}

std::vector<std::size_t> worst_first(const std::vector<ScanRow>& rows) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t k) {
    return std::pair(rows[k].judged && rows[k].counts.has_value(), false_points(rows[k]));
  };
  std::ranges::stable_sort(order, std::greater(), place);
  return order;
}

}  // namespace mosbench
