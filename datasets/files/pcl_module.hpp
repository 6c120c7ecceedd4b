#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mosbench {

/// A point cloud as it lies in a file: records of `point_step_bytes` with fields at offsets.
struct RawCloud {
  struct Field {
    std::string name;
    std::uint32_t offset_bytes = 0;
    std::uint8_t datatype =
        0;  ///< 1 to 8: int8, uint8, int16, uint16, int32, uint32, float32, float64
    std::uint32_t count = 0;
  };
  std::vector<Field> fields;
  std::vector<std::uint8_t> bytes;
  std::size_t point_step_bytes = 0;
};

/// What the module mosbench_pcl, which alone is linked with PCL, offers under the name
/// kPclModuleFunction: reads a checked .pcd file; the answer is empty or why it could not be read.
using ReadPcdCloud = std::string(const char* file, RawCloud& cloud);
inline constexpr const char* kPclModule = "mosbench_pcl.so";
inline constexpr const char* kPclModuleFunction = "mosbench_read_pcd_cloud";

}  // namespace mosbench
