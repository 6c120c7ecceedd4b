#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "datasets/formats/point_records.hpp"

namespace mosbench {

/// What an error expects where points have no times.
inline constexpr const char* kTimeFields = "a field t, time, timestamp or offset_time";

/// Whether points say by a field of this name when they were measured: t, time, timestamp or
/// offset_time.
bool is_time_field(std::string_view name);

/// Returns the first such field; nullptr when there is none.
const CloudField* find_time_field(const CloudHead& head);

/// Turns the times of all points of a scan, as stored, into nanoseconds after its stamp. Points of
/// one scan are 5 ms to 1 s apart, which tells s, ms, us and ns from one another; times since some
/// epoch (10 s and more) are taken after the stamp, or after the first of them where the stamp is
/// of another clock or there is none. Throws DataError for times that are not finite, all the same,
/// or of no such unit.
std::vector<std::int64_t> times_after_stamp_ns(std::span<const double> stored,
                                               std::optional<std::int64_t> stamp_ns,
                                               const std::filesystem::path& file);

}  // namespace mosbench
