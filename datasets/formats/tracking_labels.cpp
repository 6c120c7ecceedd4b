#include "datasets/formats/tracking_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLabelColumns = 17, kMostLabelFrames = 1'000'000;
/// KITTI has a few in a frame; each is compared with all points.
constexpr std::size_t kMostRegions = 1000;
constexpr std::string_view kRegion = "DontCare";

class LabelRow {
 public:
  LabelRow(const TextLine& line, const std::filesystem::path& file)
      : line_(line), file_(file), texts_(split_at_blanks(line.text)) {
    // Results of trackers, which people keep in the same form, have a score behind it.
    if (texts_.size() != kLabelColumns && texts_.size() != kLabelColumns + 1) {
      refuse(fmt::format("has {} columns", texts_.size()), "the 17 of KITTI's tracking labels");
    }
  }

  TrackingLabel label() const {
    TrackingLabel label;
    label.frame = frame();
    label.track = track();
    label.type = texts_[2];
    for (std::size_t i = 0; i < 4; ++i) label.region_px[i] = number(6 + i);
    for (const std::size_t i : {3U, 4U, 5U}) number(i);
    const CameraBox box = {
        number(10), number(11), number(12), {number(13), number(14), number(15)}, number(16)};
    if (label.type == kRegion) return label;
    if (label.track < 0)
      refuse("an object has the track " + mosbench::quoted(texts_[1]), "0 or more");
    if (std::min({box.height_m, box.width_m, box.length_m}) < 0.0) {
      refuse("a size is below 0", "metres");
    }
    label.box = box;
    return label;
  }

  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_, line_.number, wrong, expected);
  }

 private:
  std::size_t frame() const {
    const auto frame = parse_unsigned(texts_[0]);
    if (!frame || *frame > kMostLabelFrames) {
      refuse(mosbench::quoted(texts_[0]) + " is no frame",
             fmt::format("a number up to {}", kMostLabelFrames));
    }
    return static_cast<std::size_t>(*frame);
  }

  std::int64_t track() const {
    std::int64_t track = 0;
    const char* const end = texts_[1].data() + texts_[1].size();
    const auto parsed = std::from_chars(texts_[1].data(), end, track);
    if (parsed.ec != std::errc{} || parsed.ptr != end || track < -1) {
      refuse(mosbench::quoted(texts_[1]) + " is no track", "a whole number, -1 for DontCare");
    }
    return track;
  }

  double number(std::size_t column) const {
    const auto number = parse_double(texts_[column]);
    if (!number) refuse(mosbench::quoted(texts_[column]) + " is no number", "a number");
    return *number;
  }

  const TextLine& line_;
  const std::filesystem::path& file_;
  std::vector<std::string_view> texts_;
};

}  // namespace

std::vector<TrackingLabel> parse_tracking_labels(std::string_view text,
                                                 const std::filesystem::path& file) {
  std::vector<TrackingLabel> labels;
  std::set<std::pair<std::size_t, std::int64_t>> known;
  std::map<std::size_t, std::size_t> regions;
  for (const TextLine& line : split_lines(text, file)) {
    const LabelRow row(line, file);
    const TrackingLabel& label = labels.emplace_back(row.label());
    if (label.box && !known.emplace(label.frame, label.track).second) {
      row.refuse(fmt::format("track {} is twice in frame {}", label.track, label.frame), "once");
    }
    if (!label.box && ++regions[label.frame] > kMostRegions) {
      row.refuse(fmt::format("frame {} has more regions of DontCare", label.frame),
                 fmt::format("{} at most", kMostRegions));
    }
  }
  return labels;
}

std::string format_tracking_labels(std::span<const TrackingLabel> labels) {
  std::string text;
  for (const TrackingLabel& label : labels) {
    const auto& px = label.region_px;
    text += fmt::format("{} {} {} {} {} -10 {} {} {} {}", label.frame, label.track, label.type,
                        label.box ? 0 : -1, label.box ? 0 : -1, px[0], px[1], px[2], px[3]);
    if (label.box) {
      const CameraBox& box = *label.box;
      text += fmt::format(" {} {} {} {} {} {} {}\n", box.height_m, box.width_m, box.length_m,
                          box.bottom_m.x(), box.bottom_m.y(), box.bottom_m.z(), box.rotation_y_rad);
    } else {
      text += " -1 -1 -1 -1000 -1000 -1000 -10\n";
    }
  }
  return text;
}

}  // namespace mosbench
