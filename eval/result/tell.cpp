#include "eval/result/tell.hpp"

#include <cstdio>

#include "datasets/text/shown_text.hpp"
#include "eval/result/caller.hpp"

namespace mosbench {

void tell(std::string_view line) {
  if (!caller().quiet) std::fputs((shown(line) + '\n').c_str(), stderr);
}

}  // namespace mosbench
