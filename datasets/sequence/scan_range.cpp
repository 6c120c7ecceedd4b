#include "datasets/sequence/scan_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

std::string doubt_about_part(const Recording& recording) {
  return "only a part of the sequence is read: " + recording.reading.scans;
}

class SequencePart : public SequenceAround {
 public:
  SequencePart(std::unique_ptr<Sequence> inner, const ScanRange& range)
      : SequenceAround(std::move(inner)) {
    Recording& recording = mutable_recording();
    const std::size_t all = size() + recording.left_out.size();
    for (std::size_t k = 0; k < size(); ++k) {
      if (range.holds(scan(k).number.value_or(k))) sources_.push_back(k);
    }
    if (sources_.empty()) refuse(range);
    for (const auto entries : {&Recording::scans, &Recording::left_out}) {
      take_out(range, recording.*entries, recording.not_asked);
    }
    recording.reading.scans =
        fmt::format("{}, {} of {}", to_string(range), size(), counted(all, "scan"));
    recording.doubts.push_back(doubt_about_part(recording));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner().read(sources_.at(scan_index), frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    return inner().read_truth(sources_.at(scan_index));
  }

 private:
  [[noreturn]] void refuse(const ScanRange& range) const {
    throw UsageError(
        fmt::format("{} chooses no scan of sequence {}, which has {}, expected some of {} to {}",
                    option("scans", to_string(range)), name(), counted(size(), "scan"),
                    scan(0).number.value_or(0), scan(size() - 1).number.value_or(size() - 1)));
  }

  /// Moves what is not in the range to the end of `others`.
  static void take_out(const ScanRange& range, std::vector<ScanEntry>& scans,
                       std::vector<ScanEntry>& others) {
    std::vector<ScanEntry> kept;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      const bool is_kept = range.holds(scans[k].number.value_or(k));
      (is_kept ? kept : others).push_back(std::move(scans[k]));
    }
    scans = std::move(kept);
  }

  std::vector<std::size_t> sources_;
};

}  // namespace

ScanRange parse_scan_range(std::string_view text) {
  const auto refuse = [&](std::string_view expected) {
    throw UsageError(fmt::format("'{}' is no range of scans, expected {}", text, expected));
  };
  constexpr std::string_view kForm =
      "FROM:TO:STEP in whole numbers from 0 on, each may be left out: 10:60, 10:, :60, ::2";
  std::vector<std::optional<std::uint64_t>> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    parts.push_back(parse_unsigned(text.substr(begin, end - begin)));
    if (begin < end && !parts.back()) refuse(kForm);
    begin = end + 1;
  }
  if (text.empty() || parts.size() > 3) refuse(kForm);
  if (parts.size() == 1) parts.insert(parts.begin(), std::nullopt);
  parts.resize(3);
  const ScanRange range{parts[0].value_or(0), parts[1], parts[2].value_or(1)};
  if (range.step == 0) refuse("a STEP of 1 or more");
  if (range.to && *range.to <= range.from) refuse("a TO above FROM: it is one past the last");
  return range;
}

std::string to_string(const ScanRange& range) {
  std::string text = range.from > 0 ? fmt::format("{}:", range.from) : ":";
  if (range.to) text += fmt::format("{}", *range.to);
  if (range.step > 1) text += fmt::format(":{}", range.step);
  return text;
}

std::unique_ptr<Sequence> with_scan_range(std::unique_ptr<Sequence> inner, const ScanRange& range) {
  const std::size_t all = inner->size() + inner->recording().left_out.size();
  if (range.from == 0 && range.step == 1 && range.to.value_or(all) >= all) return inner;
  return std::make_unique<SequencePart>(std::move(inner), range);
}

std::vector<std::string> doubts_that_stay(std::vector<std::string> doubts, const Sequence& read) {
  std::erase(doubts, doubt_about_part(read.recording()));
  return doubts;
}

}  // namespace mosbench
