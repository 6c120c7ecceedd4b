#include "eval/protocols/counts_json.hpp"

namespace mosbench {

nlohmann::ordered_json counts_json(const Confusion& counts) {
  return {{"tp", counts.tp},
          {"fp", counts.fp},
          {"fn", counts.fn},
          {"tn", counts.tn},
          {"ignored", counts.ignored}};
}

}  // namespace mosbench
