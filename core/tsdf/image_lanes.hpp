#pragma once

#include "core/tsdf/lane_math.hpp"
#include "core/tsdf/sensor_model.hpp"

/// Places in a range image and depths there, eight at a time.
namespace mosbench::tsdf {

/// Turns directions into places, as place_in_image does.
struct ImageProjection {
  explicit ImageProjection(const SensorModel& sensor);

  struct Place {
    FloatLanes row, column;
  };
  /// `flat` is the length of (x, y).
  inline __attribute__((always_inline)) Place place(const FloatLanes& x, const FloatLanes& y,
                                                    const FloatLanes& z,
                                                    const FloatLanes& flat) const {
    const FloatLanes row = (up_turns - angle_turns(z, flat)) * rows_per_turn;
    const FloatLanes phi = angle_turns(-y, x) - first_turns;
    return {row, (phi < 0.0F ? phi + 1.0F : phi) * columns};
  }

  float up_turns, rows_per_turn, first_turns;
  float columns;                ///< H
  float last_row, last_column;  ///< V - 1, H - 1
};

/// The four pixels around eight places.
struct FourPixels {
  FloatLanes top_left, top_right, bottom_left, bottom_right;
};

/// Returns the depths, as depth_at does. Shares are those of the lower row and the right column.
inline __attribute__((always_inline)) FloatLanes depth_between(const FourPixels& p,
                                                               const FloatLanes& row_share,
                                                               const FloatLanes& column_share,
                                                               float half_truncation_m) {
  const auto column = [&](const FloatLanes& top, const FloatLanes& bottom, FloatLanes& least) {
    const FloatLanes less = top < bottom ? top : bottom;
    const FloatLanes between = (1.0F - row_share) * top + row_share * bottom;
    least = top == 0.0F ? bottom : (bottom == 0.0F ? top : less);
    return top == 0.0F ? bottom : (bottom == 0.0F ? top : between);
  };
  FloatLanes left_least, right_least;
  const FloatLanes left = column(p.top_left, p.bottom_left, left_least);
  const FloatLanes right = column(p.top_right, p.bottom_right, right_least);
  const FloatLanes between = (1.0F - column_share) * left + column_share * right;
  const FloatLanes depth = left == 0.0F ? right : (right == 0.0F ? left : between);
  const FloatLanes less = left_least < right_least ? left_least : right_least;
  const FloatLanes least =
      left_least == 0.0F ? right_least : (right_least == 0.0F ? left_least : less);
  return least + half_truncation_m < depth ? least : depth;
}

}  // namespace mosbench::tsdf
