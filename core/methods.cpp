#include <algorithm>
#include <mosbench/method.hpp>

#include "core/hmm_mos/method.hpp"

namespace mosbench {

std::span<const MethodKind> methods() {
  static const std::vector<MethodKind> kMethods = {
      hmm_mos::method_kind(),
      hmm_mos::reference_kind(),
  };
  return kMethods;
}

const MethodKind* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), name, &MethodKind::name);
  return found == methods().end() ? nullptr : &*found;
}

}  // namespace mosbench
