#include <array>
#include <utility>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {
namespace {

constexpr std::array<std::pair<DatasetKind, std::string_view>, 8> kNames = {{
    {DatasetKind::kDoals, "doals"},
    {DatasetKind::kSipailou, "sipailou"},
    {DatasetKind::kHelimos, "helimos"},
    {DatasetKind::kSemanticKitti, "semantickitti"},
    {DatasetKind::kApollo, "apollo"},
    {DatasetKind::kMoe, "moe"},
    {DatasetKind::kKth, "kth"},
    {DatasetKind::kMdetector, "mdetector"},
}};

}  // namespace

std::string_view to_string(DatasetKind kind) {
  for (const auto& [named, name] : kNames) {
    if (named == kind) return name;
  }
  return {};
}

std::string dataset_kind_names() {
  std::string names;
  for (const auto& [unused, name] : kNames)
    names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

bool is_written(DatasetKind kind) { return kind <= DatasetKind::kSemanticKitti; }

std::optional<DatasetKind> dataset_kind_from_string(std::string_view name) {
  for (const auto& [kind, known] : kNames) {
    if (known == name) return kind;
  }
  return std::nullopt;
}

}  // namespace mosbench
