#pragma once

#include <array>
#include <string>

#include "eval/report/picture.hpp"

namespace mosbench {

/// Colours of a light or dark picture, equal to those of the report's page. The colours of outcomes
/// can be distinguished with any colour vision.
struct Palette {
  std::array<Colour, 6> outcomes;    ///< by PointOutcome
  std::array<std::string, 6> names;  ///< of the outcomes
  Colour background, text, guide;
};

Palette palette(bool dark);

}  // namespace mosbench
