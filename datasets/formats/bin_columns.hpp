#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

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

}  // namespace mosbench
