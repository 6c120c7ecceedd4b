#pragma once

#include <memory>
#include <mosbench/method.hpp>

#include "core/base/fields.hpp"

namespace mosbench {

/// MethodKind::check of a method with such a config.
template <typename Config>
void check_settings(const Settings& settings) {
  check(config_of<Config>(settings));
}

/// MethodKind::make of a method that is made of a config and a context.
template <typename Made, typename Config>
std::unique_ptr<Method> make_method(const Settings& settings, const RunContext& context) {
  return std::make_unique<Made>(config_of<Config>(settings), context);
}

}  // namespace mosbench
