#pragma once

#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Resolution of positions in a report, metres.
inline constexpr double kPositionStep_m = 0.01;

/// Whether a point can be drawn: finite, within 327.67 m along each axis, and not a missing return
/// at the origin.
bool is_drawable(const Point& point);

/// Encodes positions as multiples of kPositionStep_m: per axis the difference from the previous
/// drawable point, zigzag-coded in 16 bits; first the low bytes of all x, of all y, of all z, then
/// the high ones. Consecutive points are close in space, so most bytes are small and compress well.
std::string position_planes(std::span<const Point> points);

/// Encodes one byte per point: its PointOutcome, plus 8 when it is not drawable.
std::string outcome_plane(std::span<const PointOutcome> outcomes, std::span<const Point> points);

/// Resolution of radial velocities in a report, m/s.
inline constexpr double kVelocityStep_m_s = 0.01;

/// Encodes radial velocities as multiples of kVelocityStep_m_s in 16 bits, -32768 where they are
/// not known or out of range: first the low bytes of all, then the high ones.
std::string velocity_planes(std::span<const float> radial_velocity_m_s);

/// Encodes four bytes per point, the bits of its float32 score: the lowest bytes of all scores,
/// then the next ones. Most are 0.
std::string score_planes(std::span<const float> scores);

/// Compresses `bytes` in zlib's format (RFC 1950) and encodes them in base64 (RFC 4648), for a
/// browser's atob() and DecompressionStream("deflate").
std::string compressed_text(std::string_view bytes);

}  // namespace mosbench
