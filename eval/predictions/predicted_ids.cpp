#include "eval/predictions/predicted_ids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kListedIds = 8;

/// Bits of the smallest and the largest float32 that confidences, classes and ids have: 1e-12 to
/// 65535. A label with such bits would have an instance number above 11,000.
constexpr std::uint32_t kSmallestFloatBits = 0x2B8CBCCC;
constexpr std::uint32_t kLargestFloatBits = 0x477FFF00;
/// Of semantic-kitti-mos.yaml.
constexpr std::uint32_t kLargestId = 259;

std::uint32_t with_bytes_reversed(std::uint32_t word) {
  return (word >> 24U) | ((word >> 8U) & 0xFF00U) | ((word << 8U) & 0xFF0000U) | (word << 24U);
}

bool may_be_float(std::uint32_t word) {
  const std::uint32_t magnitude = word & 0x7FFFFFFFU;
  return magnitude >= kSmallestFloatBits && magnitude <= kLargestFloatBits;
}

/// Returns the id in a label without its instance.
std::uint32_t id_of(std::uint32_t label) { return label & 0xFFFFU; }

bool is_id(std::uint32_t id) { return id > 0 && id <= kLargestId; }

/// Returns the encoding that gives all labels but 0 a meaning, if it is not uint32; else nothing.
std::string other_encoding(const std::vector<std::uint32_t>& labels) {
  bool any = false;
  bool floats = true;
  bool big_endian = true;
  bool small_id = false;
  for (const std::uint32_t label : labels) {
    if (label == 0) continue;
    any = true;
    floats = floats && may_be_float(label);
    const std::uint32_t reversed_id = id_of(with_bytes_reversed(label));
    big_endian = big_endian && is_id(reversed_id) && !is_id(id_of(label));
    // Larger ones could be instances of id 0.
    small_id = small_id || reversed_id < 256;
    if (!floats && !big_endian) return "";
  }
  if (!any) return "";
  if (floats) return "float32";
  return small_id ? "big-endian uint32" : "";
}

/// Writes thousands separators: "1,234,567".
std::string with_commas(std::uint64_t number) {
  std::string digits = fmt::format("{}", number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

/// Returns "251 to 259" of the ids that count as moving.
std::string moving_ids(const Protocol& protocol) {
  std::string text;
  for (const IdRange& range : protocol.prediction.ranges) {
    if (range.becomes != TruthClass::kMoving) continue;
    text += text.empty() ? "" : ", ";
    text += range.first == range.last ? fmt::format("{}", range.first)
                                      : fmt::format("{} to {}", range.first, range.last);
  }
  return text;
}

}  // namespace

std::vector<PredictedId> ids_in(std::span<const fs::path> files) {
  std::vector<std::uint64_t> points(65536, 0);
  std::vector<const fs::path*> first_file(points.size(), nullptr);
  for (const fs::path& file : files) {
    const std::string bytes = read_file(file);
    const auto labels = parse_labels(bytes, bytes.size() / sizeof(std::uint32_t), file);
    if (const std::string encoding = other_encoding(labels); !encoding.empty()) {
      throw DataError(file, "holds " + encoding, "a little-endian uint32 label id per point");
    }
    for (const std::uint32_t label : labels) {
      const std::size_t id = label & 0xFFFFU;
      if (points[id]++ == 0) first_file[id] = &file;
    }
  }
  std::vector<PredictedId> ids;
  for (std::size_t id = 0; id < points.size(); ++id) {
    if (points[id] > 0)
      ids.push_back({static_cast<std::uint16_t>(id), points[id], *first_file[id]});
  }
  return ids;
}

std::string ids_text(std::span<const PredictedId> ids) {
  std::vector<PredictedId> listed(ids.begin(), ids.end());
  std::ranges::stable_sort(listed, std::ranges::greater(), &PredictedId::points);
  listed.resize(std::min(listed.size(), kListedIds));
  std::ranges::sort(listed, std::ranges::less(), &PredictedId::id);
  std::string text;
  for (const PredictedId& id : listed) {
    text +=
        fmt::format("{}{} ({} points)", text.empty() ? "" : ", ", id.id, with_commas(id.points));
  }
  if (ids.size() > listed.size()) text += fmt::format(" and {} more", ids.size() - listed.size());
  return text;
}

std::string strange_share(std::uint64_t moving, std::uint64_t points,
                          std::span<const PredictedId> ids, const Protocol& protocol) {
  if (points == 0 || (moving > 0 && 2 * moving <= points)) return "";
  std::string text =
      moving == 0 ? "no point is predicted moving"
                  : fmt::format("{:.1f} % of the points are predicted moving",
                                100.0 * static_cast<double>(moving) / static_cast<double>(points));
  if (ids.empty()) return text;
  return text + fmt::format("; the files hold ids {}; under protocol {} ids {} are moving",
                            ids_text(ids), protocol.name, moving_ids(protocol));
}

}  // namespace mosbench
