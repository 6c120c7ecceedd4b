#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/simulation.hpp"

namespace mosbench {

/// One piece of a route: stand for `wait_s`, then go straight to `to_m` at constant speed.
struct Leg {
  std::array<double, 2> to_m{};
  double speed_m_s = 1.0;
  double wait_s = 0.0;
};

/// What happens at the end of a route's last leg: stand there, walk it back and forth, or jump to
/// its start.
enum class AfterRoute : std::uint8_t { kStay, kReturn, kRestart };

/// A path over the ground with piecewise constant speed that starts at `start_s`.
struct Route {
  std::array<double, 2> from_m{};
  std::vector<Leg> legs{};
  AfterRoute after = AfterRoute::kStay;
  double start_s = 0.0;
};

/// Who carries the sensor; decides how it bobs, sways and pitches.
enum class Carrier : std::uint8_t { kTripod, kHandHeld, kGroundRobot, kCar };

struct Ego {
  Carrier carrier = Carrier::kGroundRobot;
  double sensor_height_m = 1.0;  ///< above the ground
  Route route;
};

/// The half space below z = height_m + slope_x * x + slope_y * y. Several of them unite to hills
/// and ramps.
struct GroundPlane {
  double height_m = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
};

enum class Shape : std::uint8_t { kBox, kCylinder, kSphere };

/// Something that never moves. Less than full density makes it vegetation: a ray is stopped by each
/// occupied cell inside the shape, and only `density` of the cells are occupied.
struct Structure {
  Shape shape = Shape::kBox;
  std::array<double, 3> center_m{};
  std::array<double, 3> size_m{};  ///< full extents; cylinders stand upright
  double yaw_rad = 0.0;
  double density = 1.0;
  std::optional<double> sway_m{};       ///< how far the leaves of vegetation swing along x
  std::optional<double> let_through{};  ///< the share of rays that pass glass
  /// A box whose faces show what stands before them: points behind it, with its own truth.
  std::optional<bool> mirrors{};
  bool labelled = true;  ///< if not, its points have truth 0
};

/// A person or vehicle that follows a route over the ground.
struct Mover {
  MoverKind kind = MoverKind::kPedestrian;
  Route route;
  bool labelled = true;
  /// Whether annotators who judge by appearance (DOALS) call it dynamic while it stands; when not
  /// set, true for pedestrians and cyclists only.
  std::optional<bool> dynamic_by_appearance{};
};

/// A leaf that swings about an upright hinge from closed to open and back, once per period.
struct Door {
  std::array<double, 2> hinge_m{};
  double width_m = 1.0;
  double height_m = 2.1;
  double closed_yaw_rad = 0.0;  ///< direction from hinge to free edge
  double open_yaw_rad = 1.5;
  double swing_s = 1.0;  ///< duration of one opening or closing
  double period_s = 6.0;
  double start_s = 0.0;
  bool labelled = true;
};

/// A ball that flies freely, lies where it meets the ground, and is thrown again every period.
struct Ball {
  std::array<double, 3> from_m{};
  std::array<double, 3> velocity_m_s{};
  double radius_m = 0.12;
  double period_s = 4.0;
  double start_s = 0.0;
  bool labelled = true;
};

/// A world with everything that moves in it, as a function of time. Metres, z up.
struct Scene {
  std::string name;
  double scan_period_s = 0.1;
  std::optional<std::string> sensor;          ///< a sensor's name; the layout's own when not set
  std::optional<std::int64_t> columns;        ///< of a scanning sensor; the model's when not set
  std::optional<double> range_noise_m;        ///< standard deviation; the model's when not set
  std::optional<double> dropout_probability;  ///< of a return; the model's when not set
  /// Beams that fall on two things at most 1.5 m apart return a range between them; 0 when not set.
  std::optional<double> beam_width_rad;
  std::optional<double> ground_bumps_m;  ///< the ground rises and falls by up to so much
  Ego ego;
  std::vector<GroundPlane> ground;
  std::vector<Structure> structures;
  std::vector<Mover> movers;
  std::vector<Door> doors;
  std::vector<Ball> balls;
};

struct SceneSummary {
  std::string_view name;
  std::string_view content;  ///< one line for lists
};

/// Returns the scenes that need no file, in the order in which they are listed.
std::vector<SceneSummary> built_in_scenes();

/// Returns a scene by name. Throws UsageError with the nearest name for an unknown one.
Scene built_in_scene(std::string_view name);

/// Parses a scene in JSON strictly: throws DataError "<file>: <path in the JSON>: ..." for an
/// unknown or repeated key (naming the nearest known one), a missing key, a wrong type, a value out
/// of range, and a route that cannot be followed.
Scene parse_scene(std::string_view text, const std::filesystem::path& file);
/// Formats every field of the scene, indented; `parse_scene` gives the same scene again, bit for
/// bit.
std::string format_scene(const Scene& scene);

Scene read_scene(const std::filesystem::path& file);

}  // namespace mosbench
