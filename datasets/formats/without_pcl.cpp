#include "datasets/formats/pcl_reader.hpp"

namespace mosbench {

bool reads_pcd() { return false; }

PclCloud unpack_pcd(std::string_view, const PcdHeader&, const std::filesystem::path&) { return {}; }

}  // namespace mosbench
