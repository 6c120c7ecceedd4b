#include "eval/report/point_planes.hpp"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace mosbench {
namespace {

constexpr double kMaxSteps = 32767.0;
constexpr unsigned kNotDrawable = 8;

double steps(float value, double step) { return std::round(static_cast<double>(value) / step); }

std::uint16_t bits_of(double steps) {
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

/// The lowest bytes of all numbers, then the next ones.
template <typename Number>
std::string byte_planes(const std::vector<Number>& numbers) {
  std::string planes;
  planes.reserve(sizeof(Number) * numbers.size());
  for (unsigned bits = 0; bits < 8 * sizeof(Number); bits += 8) {
    for (const Number number : numbers) planes += static_cast<char>(number >> bits & 0xFFU);
  }
  return planes;
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
    reachable =
        reachable && std::abs(steps(position_m, kPositionStep_m)) <= kMaxSteps;  // false for NaN
  }
  return reachable;
}

std::string position_planes(std::span<const Point> points) {
  const std::size_t n = points.size();
  std::vector<std::uint16_t> codes(3 * n);
  std::array<std::uint16_t, 3> before{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_drawable(points[i])) continue;
    const std::array<float, 3> position_m = {points[i].x, points[i].y, points[i].z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint16_t now = bits_of(steps(position_m[axis], kPositionStep_m));
      codes[axis * n + i] = zigzag(static_cast<std::uint16_t>(now - before[axis]));
      before[axis] = now;
    }
  }
  return byte_planes(codes);
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
  std::vector<std::uint16_t> codes;
  for (const float velocity_m_s : radial_velocity_m_s) {
    const double code = steps(velocity_m_s, kVelocityStep_m_s);
    codes.push_back(std::abs(code) <= kMaxSteps ? bits_of(code) : kUnknown);  // also of NaN
  }
  return byte_planes(codes);
}

std::string score_planes(std::span<const float> scores) {
  std::vector<std::uint32_t> bits;
  for (const float score : scores) bits.push_back(std::bit_cast<std::uint32_t>(score));
  return byte_planes(bits);
}

std::string compressed_text(std::string_view bytes) { return base64(deflated(bytes)); }

}  // namespace mosbench
