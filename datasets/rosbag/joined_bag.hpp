#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"

namespace mosbench {

/// The files of one recording as one bag.
class JoinedBag : public BagReader {
 public:
  JoinedBag(const std::filesystem::path& folder,
            std::vector<std::unique_ptr<const BagReader>> parts);

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;
  MessageFormat format_of(const BagMessage& message) const override;

 private:
  std::vector<std::unique_ptr<const BagReader>> parts_;
};

}  // namespace mosbench
