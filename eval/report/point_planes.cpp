#include "eval/report/point_planes.hpp"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace mosbench {
namespace {

constexpr double kMaxSteps = 32767.0;
constexpr unsigned kNotDrawable = 8;

double steps(float position_m) {
  return std::round(static_cast<double>(position_m) / kPositionStep_m);
}

std::uint16_t zigzag(std::uint16_t difference) {
  const bool negative = (difference & 0x8000U) != 0;
  const unsigned doubled = static_cast<unsigned>(difference) << 1;
  return static_cast<std::uint16_t>(negative ? ~doubled : doubled);
}

constexpr int kLevel = 6;  // level 9 takes three times as long for 1 % less

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), kLevel) != Z_OK) {
    throw std::runtime_error("zlib has no memory");
  }
  packed.resize(size);
  return packed;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0U);
    }
    for (std::size_t digit = 0; digit < 4; ++digit) {
      const bool padding = i + digit > bytes.size();
      text += padding ? '=' : kDigits[group >> (18 - 6 * digit) & 0x3FU];
    }
  }
  return text;
}

}  // namespace

bool is_drawable(const Point& point) {
  const bool at_sensor = point.x == 0.0F && point.y == 0.0F && point.z == 0.0F;
  bool reachable = !at_sensor;
  for (const float position_m : {point.x, point.y, point.z}) {
    reachable = reachable && std::abs(steps(position_m)) <= kMaxSteps;  // false for NaN
  }
  return reachable;
}

std::string position_planes(std::span<const Point> points) {
  const std::size_t n = points.size();
  std::string planes(6 * n, '\0');
  std::array<std::uint16_t, 3> before{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_drawable(points[i])) continue;
    const std::array<float, 3> position_m = {points[i].x, points[i].y, points[i].z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto now =
          static_cast<std::uint16_t>(static_cast<std::int16_t>(steps(position_m[axis])));
      const std::uint16_t code = zigzag(static_cast<std::uint16_t>(now - before[axis]));
      planes[axis * n + i] = static_cast<char>(code & 0xFFU);
      planes[(3 + axis) * n + i] = static_cast<char>(code >> 8);
      before[axis] = now;
    }
  }
  return planes;
}

std::string outcome_plane(std::span<const PointOutcome> outcomes, std::span<const Point> points) {
  std::string plane;
  plane.reserve(outcomes.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const unsigned drawn = is_drawable(points[i]) ? 0 : kNotDrawable;
    plane += static_cast<char>(static_cast<unsigned>(outcomes[i]) | drawn);
  }
  return plane;
}

std::string velocity_planes(std::span<const float> radial_velocity_m_s) {
  constexpr std::uint16_t kUnknown = 0x8000U;
  const std::size_t n = radial_velocity_m_s.size();
  std::string planes(2 * n, '\0');
  for (std::size_t i = 0; i < n; ++i) {
    const double steps =
        std::round(static_cast<double>(radial_velocity_m_s[i]) / kVelocityStep_m_s);
    const bool is_known = std::abs(steps) <= kMaxSteps;  // false for NaN
    const std::uint16_t code =
        is_known ? static_cast<std::uint16_t>(static_cast<std::int16_t>(steps)) : kUnknown;
    planes[i] = static_cast<char>(code & 0xFFU);
    planes[n + i] = static_cast<char>(code >> 8);
  }
  return planes;
}

std::string score_planes(std::span<const float> scores) {
  std::string planes;
  planes.reserve(4 * scores.size());
  for (unsigned bits = 0; bits < 32; bits += 8) {
    for (const float score : scores) {
      planes += static_cast<char>(std::bit_cast<std::uint32_t>(score) >> bits & 0xFFU);
    }
  }
  return planes;
}

std::string compressed_text(std::string_view bytes) { return base64(deflated(bytes)); }

}  // namespace mosbench
