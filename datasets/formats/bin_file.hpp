#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mosbench {

inline constexpr std::size_t kUsualBinColumns = 4;  ///< x y z intensity
inline constexpr std::size_t kFewestBinColumns = 3;
inline constexpr std::size_t kMostBinColumns = 7;

/// Returns the number of float32 per point, 3 to 7, that the bytes of a .bin scan clearly have
/// instead of `columns`; nothing where they have these, where nothing is clear, as where most
/// points are missing returns, and for fewer than 64 points.
///
/// Read with the right number each column holds one quantity, read with another several. Roots of
/// differences of two numbers of a column are then larger on average, whatever the order of the
/// points is: the square root of a distance is negative definite (Szekely and Rizzo, Energy
/// statistics, 2013). That leaves chance, against which a difference must be five
/// standard errors.
std::optional<std::size_t> other_bin_columns(std::string_view bytes, std::size_t columns);

/// Returns what the numbers of a .bin scan clearly are instead of little-endian float32; empty
/// where they are these, or nothing is clear.
std::string_view other_bin_numbers(std::string_view bytes);

/// Returns the points of a scan stored as `columns` little-endian float32 per point, at least
/// three: x y z intensity, metres, and others that are left out, as nuScenes adds the ring. The
/// intensity of three is 0. No bytes are an empty scan; NaN and infinite values are kept. Throws
/// DataError when the size is no multiple of a point's.
std::vector<Point> parse_bin(std::string_view bytes, std::size_t columns,
                             const std::filesystem::path& file);
/// Returns the number after x y z intensity of every point.
std::vector<double> parse_bin_times(std::string_view bytes, std::size_t columns,
                                    const std::filesystem::path& file);
/// Returns the points' own memory as the bytes of a file.
std::string_view format_bin(std::span<const Point> points);

/// Throws the DataError of `parse_bin` when no scan has this size.
void check_bin_size(std::uintmax_t size_bytes, std::size_t columns,
                    const std::filesystem::path& file);

/// Reads a file as `parse_bin` does, into the memory of `reused` where it can.
std::vector<Point> read_bin(const std::filesystem::path& file, std::size_t columns = 4,
                            std::vector<Point> reused = {});
void write_bin(const std::filesystem::path& file, std::span<const Point> points);

}  // namespace mosbench
