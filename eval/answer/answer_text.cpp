#include "eval/answer/answer_text.hpp"

#include <fmt/format.h>

namespace mosbench {
namespace {

/// Writes DEL and C1, which JSON need not escape and terminals obey, as \u007f to \u009f.
std::string without_controls(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto byte = static_cast<unsigned char>(json[i]);
    // In UTF-8 the second byte of C1 is the character itself.
    const bool starts_c1 = byte == 0xC2 && static_cast<unsigned char>(json[i + 1]) < 0xA0;
    if (starts_c1) ++i;
    if (starts_c1 || byte == 0x7F) {
      text += fmt::format("\\u{:04x}", static_cast<unsigned char>(json[i]));
    } else {
      text += json[i];
    }
  }
  return text;
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json) {
  nlohmann::ordered_json versioned = {{"schema_version", kSchemaVersion}};
  versioned.update(json);
  return without_controls(
             versioned.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) +
         '\n';
}

std::string percent_text(const std::optional<double>& fraction, const char* style) {
  return fraction ? fmt::format(fmt::runtime(style), *fraction * 100.0) : "undefined";
}

std::string position_text(const Eigen::Vector3d& position_m) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", position_m.x(), position_m.y(), position_m.z());
}

}  // namespace mosbench
