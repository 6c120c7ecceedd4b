#pragma once

#include <functional>
#include <memory>
#include <string>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/sequence/reading.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Opens the topics `asked.lidars` of a bag as one RigSequence, or the one topic. Mounts are
/// transforms of /tf_static, or of /tf that never change. Throws DataError where there is none, and
/// as BagSequence does.
std::unique_ptr<Sequence> open_bag_lidars(
    const std::string& name, const std::function<std::unique_ptr<const BagReader>()>& open,
    const Reading& asked);

}  // namespace mosbench
