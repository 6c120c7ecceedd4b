#pragma once

#include <span>
#include <string_view>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// What somebody has to know to get a data set and lay it out as its reader expects.
struct CataloguedDataset {
  DatasetKind kind;
  std::string_view title;
  std::string_view content;
  std::string_view size;
  std::string_view published;  ///< where its authors publish it
  std::string_view licence;
  std::span<const std::string_view> folders;  ///< lines of a listing, first the root
};

std::span<const CataloguedDataset> catalogued_datasets();

}  // namespace mosbench
