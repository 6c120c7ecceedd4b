#include "datasets/formats/tracklets.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <exception>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostDepth = 16, kMostText = 256, kMostFrames = 1'000'000;
constexpr std::string_view kRoot = "/boost_serialization/tracklets";
constexpr std::string_view kTracklet = "/boost_serialization/tracklets/item";
constexpr std::string_view kPoses = "/boost_serialization/tracklets/item/poses";
constexpr std::string_view kPose = "/boost_serialization/tracklets/item/poses/item";

/// Takes the events of a parser of XML.
class TrackletEvents {
 public:
  TrackletEvents(XML_Parser parser, const std::filesystem::path& file)
      : parser_(parser), file_(file) {}

  void start(std::string_view name) {
    if (++depth_ > kMostDepth) refuse("has elements within elements", "no more than 16");
    path_ += '/';
    path_ += name;
    text_.clear();
    if (path_ == kTracklet) {
      tracklets_.emplace_back();
      values_ = {};
    } else if (path_ == kPose) {
      if (tracklets_.back().poses.size() >= kMostFrames) refuse("has too many poses", "a drive");
      tracklets_.back().poses.emplace_back();
      angles_ = {};
    }
  }

  void characters(std::string_view text) {
    if (text_.size() + text.size() > kMostText) refuse("has an element of long text", "a number");
    text_ += text;
  }

  void end(std::string_view name) {
    const std::string_view path = path_;
    if (path == kPose) {
      finish_pose();
    } else if (path == kTracklet) {
      finish_tracklet();
    } else if (path == kRoot) {
      has_root_ = true;
      if (count_ != tracklets_.size()) refuse("has another number of tracklets", "its count");
    } else {
      take(path.substr(0, path.size() - name.size() - 1), name);
    }
    text_.clear();
    path_.resize(path_.size() - name.size() - 1);
    --depth_;
  }

  std::vector<Tracklet> tracklets() && {
    if (!has_root_) refuse("has no tracklets", "tracklet_labels.xml of KITTI's raw data");
    return std::move(tracklets_);
  }

  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const {
    throw DataError(file_, XML_GetCurrentLineNumber(parser_), wrong, expected);
  }

 private:
  /// The numbers that an element may have, by its name.
  using Number = std::optional<double>;
  struct Values {
    std::optional<std::string> type;
    Number h, w, l;
    std::optional<std::size_t> first_frame, poses;
  };
  struct Placement {
    Number tx, ty, tz, rx, ry, rz;
  };

  void take(std::string_view parent, std::string_view name) {
    if (parent == kRoot && name == "count") {
      set(count_, whole(name));
    } else if (parent == kTracklet) {
      take_of_tracklet(name);
    } else if (parent == kPoses && name == "count") {
      set(values_.poses, whole(name));
    } else if (parent == kPose) {
      const std::array<std::pair<std::string_view, Number*>, 6> numbers = {{{"tx", &angles_.tx},
                                                                            {"ty", &angles_.ty},
                                                                            {"tz", &angles_.tz},
                                                                            {"rx", &angles_.rx},
                                                                            {"ry", &angles_.ry},
                                                                            {"rz", &angles_.rz}}};
      for (const auto& [key, number] : numbers) {
        if (key == name) set(*number, real(name));
      }
    }
  }

  void take_of_tracklet(std::string_view name) {
    if (name == "objectType") set(values_.type, std::string(trim(text_)));
    if (name == "h") set(values_.h, real(name));
    if (name == "w") set(values_.w, real(name));
    if (name == "l") set(values_.l, real(name));
    if (name == "first_frame") set(values_.first_frame, whole(name));
  }

  template <typename Value>
  void set(std::optional<Value>& place, Value value) const {
    if (place) refuse("has an element twice", "one");
    place = std::move(value);
  }

  double real(std::string_view name) const {
    const auto number = parse_double(trim(text_));
    if (!number) refuse(fmt::format("{} is {}", name, mosbench::quoted(text_)), "a number");
    return *number;
  }

  std::size_t whole(std::string_view name) const {
    const auto number = parse_unsigned(trim(text_));
    if (!number || *number > kMostFrames) {
      refuse(fmt::format("{} is {}", name, mosbench::quoted(text_)),
             fmt::format("a whole number up to {}", kMostFrames));
    }
    return static_cast<std::size_t>(*number);
  }

  void finish_pose() {
    const Placement& at = angles_;
    if (!at.tx || !at.ty || !at.tz || !at.rx || !at.ry || !at.rz) {
      refuse("a pose lacks numbers", "tx, ty, tz, rx, ry and rz");
    }
    if (*at.rx != 0.0 || *at.ry != 0.0) refuse("a box is turned about x or y", "about z alone");
    tracklets_.back().poses.back() = {{*at.tx, *at.ty, *at.tz}, *at.rz};
  }

  void finish_tracklet() {
    Tracklet& tracklet = tracklets_.back();
    if (!values_.type || !values_.h || !values_.w || !values_.l || !values_.first_frame) {
      refuse("a tracklet lacks elements", "objectType, h, w, l and first_frame");
    }
    if (std::min({*values_.h, *values_.w, *values_.l}) < 0.0) refuse("a size is below 0", "metres");
    if (values_.poses != tracklet.poses.size()) {
      refuse("a tracklet has another number of poses", "its count");
    }
    tracklet.type = *values_.type;
    tracklet.height_m = *values_.h;
    tracklet.width_m = *values_.w;
    tracklet.length_m = *values_.l;
    tracklet.first_frame = *values_.first_frame;
  }

  XML_Parser parser_;
  const std::filesystem::path& file_;
  std::string path_, text_;
  std::size_t depth_ = 0;
  bool has_root_ = false;
  std::optional<std::size_t> count_;
  Values values_;
  Placement angles_;
  std::vector<Tracklet> tracklets_;
};

/// What expat's callbacks get: no exception may pass through C.
struct Context {
  XML_Parser parser;
  TrackletEvents events;
  std::exception_ptr thrown = nullptr;

  template <typename Call>
  void guard(Call&& call) noexcept {
    if (thrown) return;
    try {
      call();
    } catch (...) {
      thrown = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
};

Context& context_of(void* user) { return *static_cast<Context*>(user); }

void set_callbacks(XML_Parser parser, Context& context) {
  ::XML_SetUserData(parser, &context);
  ::XML_SetElementHandler(
      parser,
      [](void* user, const XML_Char* name, const XML_Char**) {
        Context& at = context_of(user);
        at.guard([&] { at.events.start(name); });
      },
      [](void* user, const XML_Char* name) {
        Context& at = context_of(user);
        at.guard([&] { at.events.end(name); });
      });
  ::XML_SetCharacterDataHandler(parser, [](void* user, const XML_Char* text, int length) {
    Context& at = context_of(user);
    at.guard([&] { at.events.characters({text, static_cast<std::size_t>(length)}); });
  });
  ::XML_SetEntityDeclHandler(
      parser, [](void* user, const XML_Char*, int, const XML_Char*, int, const XML_Char*,
                 const XML_Char*, const XML_Char*, const XML_Char*) {
        Context& at = context_of(user);
        at.guard([&] { at.events.refuse("declares an entity", "plain elements"); });
      });
}

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

std::vector<Tracklet> parse_tracklets(std::string_view text, const std::filesystem::path& file) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Context context{parser.get(), TrackletEvents(parser.get(), file)};
  set_callbacks(parser.get(), context);
  constexpr std::size_t kPieceBytes = 1 << 20;
  bool is_last = false;
  while (!is_last) {
    const std::string_view piece = text.substr(0, kPieceBytes);
    text.remove_prefix(piece.size());
    is_last = text.empty();
    const auto status = XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()),
                                  is_last ? XML_TRUE : XML_FALSE);
    if (context.thrown) std::rethrow_exception(context.thrown);
    if (status == XML_STATUS_ERROR) {
      context.events.refuse(
          fmt::format("is no XML ({})", XML_ErrorString(XML_GetErrorCode(parser.get()))),
          "tracklet_labels.xml of KITTI's raw data");
    }
  }
  return std::move(context.events).tracklets();
}

std::string format_tracklets(std::span<const Tracklet> tracklets) {
  const auto escaped = [](const std::string& text) {
    std::string safe;
    for (const char c : text) {
      safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return safe;
  };
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n"
      "<!DOCTYPE boost_serialization>\n"
      "<boost_serialization signature=\"serialization::archive\" version=\"9\">\n"
      "<tracklets class_id=\"0\" tracking_level=\"0\" version=\"0\">\n";
  text += fmt::format("\t<count>{}</count>\n\t<item_version>1</item_version>\n", tracklets.size());
  for (const Tracklet& t : tracklets) {
    text += fmt::format(
        "\t<item>\n\t\t<objectType>{}</objectType>\n\t\t<h>{}</h><w>{}</w><l>{}</l>\n"
        "\t\t<first_frame>{}</first_frame>\n\t\t<poses>\n\t\t\t<count>{}</count>\n"
        "\t\t\t<item_version>2</item_version>\n",
        escaped(t.type), t.height_m, t.width_m, t.length_m, t.first_frame, t.poses.size());
    for (const TrackletPose& pose : t.poses) {
      text += fmt::format(
          "\t\t\t<item><tx>{}</tx><ty>{}</ty><tz>{}</tz><rx>0</rx><ry>0</ry><rz>{}</rz>"
          "<state>2</state><occlusion>0</occlusion><occlusion_kf>0</occlusion_kf>"
          "<truncation>0</truncation></item>\n",
          pose.bottom_m.x(), pose.bottom_m.y(), pose.bottom_m.z(), pose.yaw_rad);
    }
    text += "\t\t</poses>\n\t\t<finished>1</finished>\n\t</item>\n";
  }
  return text + "</tracklets>\n</boost_serialization>\n";
}

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
