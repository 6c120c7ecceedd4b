#include <algorithm>
#include <mosbench/method.hpp>

namespace mosbench {

/// Each method defines its own, at the end of its pipeline.cpp or row.cpp.
// clang-format off
namespace hmm_mos { MethodKind method_kind(); MethodKind reference_kind(); }
namespace hmm_mos_plus { MethodKind method_kind(); }
namespace dynablox { MethodKind method_kind(); }
namespace lc_free_space { MethodKind method_kind(); }
namespace underwood { MethodKind method_kind(); }
namespace dufomap { MethodKind method_kind(); }
namespace octomap { MethodKind method_kind(); }
namespace yoon { MethodKind method_kind(); }
// clang-format on

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

const MethodKind& default_method() { return methods().front(); }

const MethodKind* find_method(std::string_view name) {
  const auto found = std::ranges::find(methods(), name, &MethodKind::name);
  return found == methods().end() ? nullptr : &*found;
}

}  // namespace mosbench
