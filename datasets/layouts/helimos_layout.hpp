#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace mosbench {

/// Folders of HeLiMOS as it is published: the place, in it the scans, in it the sensors.
inline constexpr const char* kHelimosPlace = "KAIST05";
inline constexpr const char* kHelimosScans = "Deskewed_LiDAR";
inline constexpr std::array<const char*, 4> kHelimosSensors = {"Aeva", "Avia", "Ouster",
                                                               "Velodyne"};

/// Returns the folder of the sensors and of the split files, relative to the root.
inline std::filesystem::path helimos_folder() {
  return std::filesystem::path(kHelimosPlace) / kHelimosScans;
}

/// Numbers of scans by the split's name: train, val, test.
using HelimosSplits = std::map<std::string, std::set<std::uint64_t>>;

/// Writes the split files, one set for all sensors, of the splits that have a scan.
void write_helimos_splits(const std::filesystem::path& root, const HelimosSplits& splits);

}  // namespace mosbench
