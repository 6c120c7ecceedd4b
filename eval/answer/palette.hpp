#pragma once

#include <string>
#include <vector>

#include "eval/answer/picture.hpp"

namespace mosbench {

/// A colour and what it stands for.
struct Swatch {
  Colour colour;
  std::string name;
  std::string name_without_truth;  ///< the same but for outcomes
};

/// Colours of a light or dark picture, equal to those of the report's page. Those of outcomes and
/// those of reasons can be distinguished with any colour vision.
struct Palette {
  std::vector<Swatch> outcomes;  ///< by PointOutcome
  std::vector<Swatch> reasons;   ///< by Reason
  Colour background, text, guide;
};

Palette palette(bool dark);

}  // namespace mosbench
