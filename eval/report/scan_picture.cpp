#include "eval/report/scan_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "eval/report/label_products.hpp"
#include "eval/report/point_planes.hpp"

namespace mosbench {
namespace {

constexpr double kElevation_rad = std::numbers::pi / 6.0;
/// Distance of the camera from the sensor in ranges: near enough for depth, far enough for all.
constexpr double kRangesAway = 1.6;
/// What is nearer than this share of it hides the picture.
constexpr double kNearest = 0.05;

/// Returns the corners of a box in the map: the four of its bottom in a circle, then those above.
std::array<Eigen::Vector3d, 8> corners_of(const MovingBox& box) {
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double x = i % 4 == 0 || i % 4 == 3 ? 0.5 : -0.5;
    const double y = i % 4 < 2 ? 0.5 : -0.5;
    const double z = i < 4 ? -0.5 : 0.5;
    corners[i] = box.map_from_box * box.size_m.cwiseProduct(Eigen::Vector3d(x, y, z));
  }
  return corners;
}

constexpr int kMargin = 12;

/// A text whose upper left corner is at x, y.
struct Label {
  int x, y;
  std::string text;
  Colour colour;
};

/// Whether a point is drawn over the background. Such points are drawn in stored order: where right
/// and wrong ones overlap, the picture shows the more frequent kind.
bool stands_out(PointOutcome outcome) {
  return outcome != PointOutcome::kTrueNegative && outcome != PointOutcome::kIgnoredStatic;
}
bool stands_out(Reason reason) { return reason != Reason::kNone; }
bool stands_out(ErrorScene scene) { return scene != ErrorScene::kNone; }

/// What the points of a scan are drawn as.
struct Kinds {
  std::vector<Swatch> swatches;
  std::vector<std::size_t> of_point;  ///< positions in swatches
  std::vector<bool> stand_out;        ///< by point
};

template <typename Kind>
Kinds kinds_of(const std::vector<Kind>& of_points, std::vector<Swatch> swatches) {
  Kinds kinds{std::move(swatches), {}, {}};
  for (const Kind kind : of_points) {
    kinds.of_point.push_back(static_cast<std::size_t>(kind));
    kinds.stand_out.push_back(stands_out(kind));
  }
  return kinds;
}

/// Where nothing is judged, the two outcomes that are left have plainer names.
Kinds kinds_of_outcomes(const JudgedScan& scan, std::vector<Swatch> swatches) {
  const bool has_truth = std::ranges::any_of(scan.outcomes, [](PointOutcome outcome) {
    return outcome != PointOutcome::kIgnoredStatic && outcome != PointOutcome::kIgnoredMoving;
  });
  for (Swatch& swatch : swatches) {
    if (!has_truth) swatch.name = swatch.name_without_truth;
  }
  return kinds_of(scan.outcomes, std::move(swatches));
}

/// Returns a round number of metres that gives three to eight rings.
double ring_step_m(double range_m) {
  double step_m = 1.0;
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5, 2.0}) {
    if (range_m / step_m <= 8.0) break;
    step_m *= factor;
  }
  return step_m;
}

/// Returns the height in the sensor frame that a twentieth of the points lie below.
double ground_height_m(const JudgedScan& scan) {
  std::vector<double> heights_m;
  for (const Point& point : scan.frame.points) {
    if (is_drawable(point)) heights_m.push_back(static_cast<double>(point.z));
  }
  if (heights_m.empty()) return 0.0;
  const auto low = heights_m.begin() + static_cast<std::ptrdiff_t>(heights_m.size() / 20);
  std::ranges::nth_element(heights_m, low);
  return *low;
}

Kinds kinds_of(const JudgedScan& scan, const ScanPictureOptions& options, const Palette& palette) {
  if (!options.scenes.empty()) return kinds_of(options.scenes, palette.scenes);
  return options.by_reason ? kinds_of(scan.reasons, palette.reasons)
                           : kinds_of_outcomes(scan, palette.outcomes);
}

class ScanPicture {
 public:
  ScanPicture(const JudgedScan& scan, const ScanPictureOptions& options)
      : scan_(scan),
        options_(options),
        palette_(palette(options.dark)),
        kinds_(kinds_of(scan, options, palette_)),
        range_m_(options.range_m > 0.0 ? options.range_m : reach_m(scan)),
        view_(options.orbit_rad, range_m_, static_cast<double>(options.size_pixels)),
        text_scale_(std::max(1, static_cast<int>(options.size_pixels + 500) / 1000)),
        picture_(options.size_pixels, options.size_pixels, palette_.background) {}

  Picture draw() && {
    draw_rings();
    for (const bool standing_out : {false, true}) draw_points(standing_out);
    draw_sensor();
    for (const MovingBox& box : options_.boxes) draw_moving_box(box);
    for (const Label& label : labels_) draw_label(label);
    draw_legend();
    draw_box(kMargin, kMargin, title());
    return std::move(picture_);
  }

 private:
  void draw_rings() {
    const double ground_m = view_.is_from_above() ? 0.0 : ground_height_m(scan_);
    const double step_m = ring_step_m(range_m_);
    const Colour label_colour =
        palette_.outcomes[static_cast<std::size_t>(PointOutcome::kTrueNegative)].colour;
    for (double radius_m = step_m; radius_m <= range_m_; radius_m += step_m) {
      draw_ring(radius_m, ground_m);
      const auto top = view_.seen({radius_m, 0.0, ground_m});
      if (!top) continue;
      add_label({static_cast<int>(top->x) + 4, static_cast<int>(top->y) + 2,
                 fmt::format("{:g} m", radius_m), label_colour});
    }
  }

  void draw_ring(double radius_m, double ground_m) {
    const double middle = static_cast<double>(options_.size_pixels) / 2.0;
    if (view_.is_from_above()) {
      picture_.ring(middle, middle, radius_m * view_.pixels_per_m(), palette_.guide);
      return;
    }
    constexpr int kSides = 72;
    for (int side = 0; side < kSides; ++side) {
      const auto corner = [&](int i) {
        const double angle_rad = 2.0 * std::numbers::pi * i / kSides;
        return Eigen::Vector3d(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad),
                               ground_m);
      };
      draw_edge(corner(side), corner(side + 1), 1.0, palette_.guide);
    }
  }

  void draw_edge(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double width,
                 Colour colour) {
    const auto from = view_.seen(from_m), to = view_.seen(to_m);
    if (from && to) picture_.line(from->x, from->y, to->x, to->y, width, colour);
  }

  /// Points in the order in which they are drawn: from above as they are stored, else far ones
  /// first.
  std::vector<std::pair<ViewedPoint, Colour>> seen_points(bool standing_out) const {
    std::vector<std::pair<ViewedPoint, Colour>> points;
    for (std::size_t i = 0; i < kinds_.of_point.size(); ++i) {
      const Point& point = scan_.frame.points[i];
      if (kinds_.stand_out[i] != standing_out || !is_drawable(point)) continue;
      const Colour colour = kinds_.swatches[kinds_.of_point[i]].colour;
      if (const auto seen = view_.seen(position_of(point))) points.emplace_back(*seen, colour);
    }
    if (!view_.is_from_above()) {
      std::ranges::stable_sort(points, std::greater(),
                               [](const auto& point) { return point.first.distance_m; });
    }
    return points;
  }

  void draw_points(bool standing_out) {
    const double radius = standing_out ? 2.0 : 0.9;
    for (const auto& [seen, colour] : seen_points(standing_out)) {
      picture_.disc(seen.x, seen.y, radius * std::clamp(seen.scale, 0.6, 2.0), colour);
    }
  }

  void draw_sensor() {
    const auto sensor = view_.seen(Eigen::Vector3d::Zero());
    if (sensor) picture_.disc(sensor->x, sensor->y, 3.5, palette_.text);
  }

  void draw_moving_box(const MovingBox& box) {
    std::array<Eigen::Vector3d, 8> corners = corners_of(box);
    const Pose sensor_from_map = scan_.frame.map_from_sensor.inverse();
    for (Eigen::Vector3d& corner : corners) corner = sensor_from_map * corner;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t next = (i + 1) % 4;
      draw_edge(corners[i], corners[next], 2.0, palette_.text);
      draw_edge(corners[i + 4], corners[next + 4], 2.0, palette_.text);
      draw_edge(corners[i], corners[i + 4], 2.0, palette_.text);
    }
    const auto label = view_.seen(corners[4]);
    if (!label || !box.velocity_m_s) return;
    add_label({static_cast<int>(label->x), static_cast<int>(label->y) - glyph_height(),
               fmt::format("{:.1f} m/s", box.velocity_m_s->norm()), palette_.text});
  }

  /// The lines of the title, cut to the picture; the last one says where there are more.
  std::vector<std::string> title() const {
    const auto room = static_cast<int>(options_.size_pixels);
    const int letter = text_scale_ * Picture::kGlyphWidth;
    std::vector<std::string> lines =
        wrapped(options_.title, static_cast<std::size_t>((room - 4 * kMargin) / letter));
    const auto most = static_cast<std::size_t>((room - 3 * kMargin) / line_height());
    if (lines.size() <= most) return lines;
    lines.resize(most);
    lines.back() = "... and more";
    return lines;
  }

  int glyph_height() const { return text_scale_ * Picture::kGlyphHeight; }
  int line_height() const { return glyph_height() + 2 * text_scale_; }
  int width_of(const std::string& text) const {
    return text_scale_ * Picture::kGlyphWidth * static_cast<int>(text.size());
  }

  bool overlap(const Label& a, const Label& b) const {
    return a.x < b.x + width_of(b.text) && b.x < a.x + width_of(a.text) &&
           std::abs(a.y - b.y) < glyph_height();
  }

  /// Keeps a label for when the points are drawn, above those that are there.
  void add_label(Label label) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const Label& other : labels_) {
        if (!overlap(label, other)) continue;
        label.y = other.y - glyph_height();
        moved = true;
      }
    }
    labels_.push_back(std::move(label));
  }

  void draw_label(const Label& label) {
    constexpr double kVeil = 0.6;
    picture_.rectangle(label.x - 2, label.y, width_of(label.text) + 4, glyph_height(),
                       palette_.background, kVeil);
    picture_.text(label.x, label.y, label.text, label.colour, text_scale_);
  }

  /// Draws lines of text on a filled box; returns its height in pixels.
  int draw_box(int x, int y, const std::vector<std::string>& lines, int indent = 0) {
    int longest = 0;
    for (const std::string& line : lines) longest = std::max(longest, width_of(line));
    const int width = longest + 2 * kMargin + indent;
    const int height = static_cast<int>(lines.size()) * line_height() + kMargin;
    picture_.rectangle(x, y, width, height, palette_.background, 0.88);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      picture_.text(x + kMargin + indent, y + kMargin / 2 + static_cast<int>(i) * line_height(),
                    lines[i], palette_.text, text_scale_);
    }
    return height;
  }

  void draw_legend() {
    std::vector<std::size_t> counts(kinds_.swatches.size());
    for (const std::size_t kind : kinds_.of_point) ++counts[kind];
    std::vector<std::string> lines;
    std::vector<Colour> swatches;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] == 0) continue;
      const Swatch& swatch = kinds_.swatches[i];
      lines.push_back(fmt::format("{:<25} {:>8}", swatch.name, counts[i]));
      swatches.push_back(swatch.colour);
    }
    const int indent = 18 * text_scale_;
    const int top = static_cast<int>(options_.size_pixels) - kMargin -
                    static_cast<int>(lines.size()) * line_height() - kMargin;
    draw_box(kMargin, top, lines, indent);
    for (std::size_t i = 0; i < swatches.size(); ++i) {
      const int middle =
          top + kMargin / 2 + static_cast<int>(i) * line_height() + line_height() / 2;
      picture_.disc(2 * kMargin + 5 * text_scale_, middle, 5.0 * text_scale_ + 1.0, palette_.text);
      picture_.disc(2 * kMargin + 5 * text_scale_, middle, 5.0 * text_scale_, swatches[i]);
    }
  }

  const JudgedScan& scan_;
  const ScanPictureOptions& options_;
  Palette palette_;
  Kinds kinds_;
  double range_m_;
  ScanView view_;
  int text_scale_;  ///< large pictures have large text
  Picture picture_;
  std::vector<Label> labels_;
};

}  // namespace

ScanView::ScanView(const std::optional<double>& orbit_rad, double range_m, double size_pixels)
    : orbits_(orbit_rad.has_value()), middle_(size_pixels / 2.0), pixels_per_m_(middle_ / range_m) {
  if (!orbits_) return;
  away_m_ = kRangesAway * range_m;
  const Eigen::Vector3d forward(std::cos(*orbit_rad) * std::cos(kElevation_rad),
                                std::sin(*orbit_rad) * std::cos(kElevation_rad),
                                -std::sin(kElevation_rad));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera_from_sensor_.row(0) = right;
  camera_from_sensor_.row(1) = right.cross(forward);
  camera_from_sensor_.row(2) = forward;
}

std::optional<ViewedPoint> ScanView::seen(const Eigen::Vector3d& point_m) const {
  if (!orbits_) {
    return ViewedPoint{middle_ - point_m.y() * pixels_per_m_,
                       middle_ - point_m.x() * pixels_per_m_};
  }
  const Eigen::Vector3d in_camera = camera_from_sensor_ * point_m;
  const double distance_m = in_camera.z() + away_m_;
  if (distance_m < kNearest * away_m_) return std::nullopt;
  const double scale = away_m_ / distance_m;
  return ViewedPoint{middle_ + in_camera.x() * pixels_per_m_ * scale,
                     middle_ - in_camera.y() * pixels_per_m_ * scale, distance_m, scale};
}

double reach_m(const JudgedScan& scan) {
  std::vector<double> distances_m;
  for (const Point& point : scan.frame.points) {
    if (is_drawable(point))
      distances_m.push_back(std::hypot(static_cast<double>(point.x), static_cast<double>(point.y)));
  }
  if (distances_m.empty()) return 10.0;
  const auto most = distances_m.begin() +
                    static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(distances_m.size() - 1));
  std::ranges::nth_element(distances_m, most);
  return 5.0 * std::max(1.0, std::ceil(*most / 5.0));
}

Picture scan_picture(const JudgedScan& scan, const ScanPictureOptions& options) {
  return ScanPicture(scan, options).draw();
}

}  // namespace mosbench
