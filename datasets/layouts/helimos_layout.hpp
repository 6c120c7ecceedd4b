#pragma once

#include <array>
#include <filesystem>

namespace mosbench {

/// Folders of HeLiMOS as it is published: its place, below it the scans, below them the sensors.
inline constexpr const char* kHelimosPlace = "KAIST05";
inline constexpr const char* kHelimosScans = "Deskewed_LiDAR";
inline constexpr std::array<const char*, 4> kHelimosSensors = {"Aeva", "Avia", "Ouster",
                                                               "Velodyne"};

/// The folder of the sensors and of the split files, relative to the root.
inline std::filesystem::path helimos_folder() {
  return std::filesystem::path(kHelimosPlace) / kHelimosScans;
}

}  // namespace mosbench
