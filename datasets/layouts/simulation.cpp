#include "datasets/layouts/simulation.hpp"

#include "datasets/formats/label_file.hpp"

namespace mosbench {

std::uint32_t moving_label(const SimulatedReturn& seen) {
  if (!seen.owner.labelled) return 0;
  return seen.owner.moving ? kMovingLabel : kStaticLabel;
}

std::uint32_t with_instance(std::uint32_t label, std::uint32_t owner_number,
                            std::uint32_t instances) {
  constexpr std::uint32_t kInstanceBits = 16;
  return label | (owner_number % instances) << kInstanceBits;
}

bool is_movable(const OwnerState& owner) { return owner.substance >= Substance::kMoverBody; }

std::set<std::size_t> every_labelled(std::size_t step, std::size_t scans) {
  constexpr std::size_t kFirst = 4;
  std::set<std::size_t> labelled;
  for (std::size_t i = kFirst; i < scans; i += step) labelled.insert(i);
  return labelled;
}

std::optional<std::int64_t> no_stamp(std::int64_t, std::int64_t) { return std::nullopt; }

}  // namespace mosbench
