#include "datasets/sequence/scan_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

std::string doubt_about_part(const Recording& recording) {
  return "only a part of the sequence is read: " + recording.reading.scans;
}

/// A sequence without some of its scans.
class SequencePart : public SequenceAround {
 public:
  /// `kept` has one value per scan.
  SequencePart(std::unique_ptr<Sequence> inner, const std::vector<bool>& kept)
      : SequenceAround(std::move(inner)) {
    Recording& recording = mutable_recording();
    std::vector<ScanEntry> scans;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      ScanEntry& entry = recording.scans[k];
      entry.number = entry.number.value_or(k);
      if (kept[k]) sources_.push_back(k);
      (kept[k] ? scans : recording.not_asked).push_back(std::move(entry));
    }
    recording.scans = std::move(scans);
  }

  using Sequence::mutable_recording;
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner().read(sources_.at(scan_index), frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    return inner().read_truth(sources_.at(scan_index));
  }

 private:
  std::vector<std::size_t> sources_;
};

[[noreturn]] void refuse(const Sequence& sequence, const ScanRange& range) {
  const std::size_t last = sequence.size() - 1;
  throw UsageError(
      fmt::format("{} chooses no scan of sequence {}, which has {}, expected some of {} to {}",
                  option("scans", to_string(range)), sequence.name(), counted(last + 1, "scan"),
                  sequence.scan(0).number.value_or(0), sequence.scan(last).number.value_or(last)));
}

/// Scans that are not worth reading.
struct UselessScans {
  std::vector<bool> kept;  ///< all others
  std::size_t empty = 0, repeated = 0;
};

/// Reads the scans of which another one has as many points.
UselessScans useless_scans(const Sequence& sequence) {
  std::unordered_map<std::size_t, std::size_t> scans_of_size;
  for (const ScanEntry& scan : sequence.recording().scans) ++scans_of_size[scan.points];
  UselessScans useless;
  std::unordered_set<std::string> seen;
  Frame frame;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const bool is_empty = sequence.point_count(k) == 0;
    bool is_repeated = false;
    if (!is_empty && scans_of_size[sequence.point_count(k)] > 1) {
      sequence.read(k, frame);
      const auto* bytes = reinterpret_cast<const char*>(frame.points.data());
      is_repeated = !seen.insert(hash_of_text({bytes, frame.points.size() * sizeof(Point)})).second;
    }
    useless.empty += is_empty ? 1U : 0U;
    useless.repeated += is_repeated ? 1U : 0U;
    useless.kept.push_back(!is_empty && !is_repeated);
  }
  return useless;
}

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
  const auto holds = [&](const ScanEntry& scan) { return range.holds(*scan.number); };
  std::vector<bool> kept;
  for (std::size_t k = 0; k < inner->size(); ++k) {
    kept.push_back(range.holds(inner->scan(k).number.value_or(k)));
  }
  if (std::ranges::find(kept, true) == kept.end()) refuse(*inner, range);
  auto part = std::make_unique<SequencePart>(std::move(inner), kept);
  Recording& recording = part->mutable_recording();
  const auto others = std::ranges::stable_partition(recording.left_out, holds);
  std::ranges::move(others, std::back_inserter(recording.not_asked));
  recording.left_out.erase(others.begin(), others.end());
  recording.reading.scans =
      fmt::format("{}, {} of {}", to_string(range), part->size(), counted(all, "scan"));
  recording.doubts.push_back(doubt_about_part(recording));
  return part;
}

std::unique_ptr<Sequence> without_useless_scans(std::unique_ptr<Sequence> inner) {
  const UselessScans useless = useless_scans(*inner);
  const std::string found = fmt::format("{} empty, {} repeated", useless.empty, useless.repeated);
  if (std::ranges::find(useless.kept, true) == useless.kept.end()) {
    throw UsageError(fmt::format("{} leaves no scan of sequence {}, expected one with points",
                                 option("drop_scans", "auto"), inner->name()));
  }
  auto part = std::make_unique<SequencePart>(std::move(inner), useless.kept);
  part->mutable_recording().reading.drop_scans = found;
  part->mutable_recording().remarks.push_back("scans left out: " + found);
  return part;
}

std::vector<std::string> doubts_that_stay(std::vector<std::string> doubts, const Sequence& read) {
  std::erase(doubts, doubt_about_part(read.recording()));
  return doubts;
}

}  // namespace mosbench
