#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// Adds the parts of the built-in scenes. Positions that do not matter are drawn from a generator
/// with a fixed seed, so a built-in scene is always the same.
class SceneBuilder {
 public:
  explicit SceneBuilder(Scene& scene, std::uint64_t start) : scene_(scene), seed_(start) {}

  /// Returns a number uniform in [lowest, highest), in whole hundredths. Not to be called twice in
  /// the arguments of one call: compilers differ in which they evaluate first.
  double draw(double lowest, double highest);

  void box(std::array<double, 2> center_m, double floor_m, std::array<double, 3> size_m,
           double yaw_rad = 0.0);
  void pole(std::array<double, 2> at_m, double diameter_m, double height_m);
  void hedge(std::array<double, 2> center_m, std::array<double, 3> size_m);
  /// Adds a trunk and a crown that lets part of the rays through.
  void tree(std::array<double, 2> at_m);
  /// Adds the four walls of a rectangle, with a gap of `gap_m` in the middle of the one at low y.
  void room_walls(std::array<double, 2> low_m, std::array<double, 2> high_m, double height_m,
                  double gap_m);
  /// Adds somebody who walks between points at `speed_m_s`, back and forth, standing `wait_s`
  /// before each leg.
  void wanderer(MoverKind kind, const std::vector<std::array<double, 2>>& points_m,
                double speed_m_s, double wait_s, double start_s = 0.0);
  void mover(MoverKind kind, const Route& route);

 private:
  double ground_m(std::array<double, 2> at_m) const;

  Scene& scene_;
  std::uint64_t seed_;
  std::uint64_t drawn_ = 0;
};

/// Returns the closed path through the corners of a rectangle, counter-clockwise unless
/// `clockwise`, that starts at `fraction` of its length; every leg at `speed_m_s`, after standing
/// `wait_s` at each corner.
Route rectangle_route(std::array<double, 2> low_m, std::array<double, 2> high_m, bool clockwise,
                      double fraction, double speed_m_s, double wait_s = 0.0);

}  // namespace mosbench
