#include <algorithm>
#include <mosbench/method.hpp>

#include "core/methods/dufomap/method.hpp"
#include "core/methods/dynablox/method.hpp"
#include "core/methods/hmm_mos/method.hpp"
#include "core/methods/hmm_mos_plus/method.hpp"
#include "core/methods/lc_free_space/method.hpp"
#include "core/methods/octomap/method.hpp"
#include "core/methods/underwood/method.hpp"
#include "core/methods/yoon/method.hpp"

namespace mosbench {

std::span<const MethodKind> methods() {
  // clang-format off
  static const std::vector<MethodKind> kMethods = {
      hmm_mos::method_kind(),
      hmm_mos::reference_kind(),
      hmm_mos_plus::method_kind(),
      dynablox::method_kind(),
      lc_free_space::method_kind(),
      underwood::method_kind(),
      dufomap::method_kind(),
      octomap::method_kind(),
      yoon::method_kind(),
  };
  // clang-format on
  return kMethods;
}

const MethodKind* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), name, &MethodKind::name);
  return found == methods().end() ? nullptr : &*found;
}

}  // namespace mosbench
