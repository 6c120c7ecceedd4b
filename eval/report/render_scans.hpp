#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "eval/answer/answer.hpp"
#include "eval/report/scan_picture.hpp"

namespace mosbench {

/// Which scans of a result are drawn, and how.
struct RenderOptions {
  std::filesystem::path input, out;
  std::optional<std::filesystem::path> dataset_root;
  std::optional<std::string> sequence;
  std::string scans;
  double per_s = 10.0;
  std::optional<double> azimuth_deg;  ///< of a camera around the sensor; nothing: from above
  std::optional<double> turn_deg;     ///< that it goes on over several scans
  bool boxes = false;
  bool scenes = false;  ///< colours say what lies around false and missed points

  /// Whether one picture is drawn: of a scan by its number, or of the worst.
  bool one_scan() const {
    return scans == "worst" ||
           (!scans.empty() && scans.find_first_not_of("0123456789") == scans.npos);
  }
  ScanPictureOptions picture;
};

/// Draws them: one as a picture, several as a video or a folder of pictures. Throws UsageError and
/// DataError.
Answer render_scans(RenderOptions options);

}  // namespace mosbench
