#include "eval/store/same_input.hpp"

#include "datasets/sequence/fingerprint.hpp"

namespace mosbench {

bool same_input(const Sequence& sequence, const std::optional<std::string>& stamp,
                const ResultFile& result) {
  if (stamp && result.content["timing"].value("file_stamp", "") == *stamp) return true;
  ContentFingerprint fingerprint;
  for (std::size_t k = 0; k < sequence.size(); ++k) fingerprint.add(sequence.read(k));
  return fingerprint.hex() == result.rows.fingerprint;
}

}  // namespace mosbench
