#include "datasets/text/errors.hpp"
#include "eval/truth/review.hpp"

namespace mosbench {

void serve_review(const std::filesystem::path&, const std::optional<std::filesystem::path>&,
                  const std::function<void(const std::string&)>&) {
  throw UsageError(
      "truth review: this build lacks cpp-httplib, expected one made with Debian's "
      "libcpp-httplib-dev; decisions.json can be written by hand, see mosbench truth --help-all");
}

}  // namespace mosbench
