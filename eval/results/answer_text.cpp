#include "eval/results/answer_text.hpp"

#include <fmt/format.h>

namespace mosbench {

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string percent_text(const std::optional<double>& fraction, const char* style) {
  return fraction ? fmt::format(fmt::runtime(style), *fraction * 100.0) : "undefined";
}

std::string position_text(const Eigen::Vector3d& position_m) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", position_m.x(), position_m.y(), position_m.z());
}

}  // namespace mosbench
