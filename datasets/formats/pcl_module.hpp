#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/point_records.hpp"

namespace mosbench {

/// The points of a PCD file, unpacked: records of `head.point_step_bytes` with fields at offsets.
struct PclCloud {
  CloudHead head;  ///< fields and point step
  std::vector<std::uint8_t> records;
};

/// The function of the module mosbench_pcl, which is the only one linked with PCL, by the name
/// kPclModuleFunction: unpacks a checked .pcd file whose body starts at `body_offset_bytes`.
/// Returns an empty text or why that failed.
using UnpackPcd = std::string(std::string_view bytes, std::size_t body_offset_bytes,
                              PclCloud& cloud);
inline constexpr const char* kPclModule = "mosbench_pcl.so";
inline constexpr const char* kPclModuleFunction = "mosbench_unpack_pcd";

}  // namespace mosbench
