#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// Whether pictures of several scans go into one file: .mp4 or .gif.
bool is_video(const std::filesystem::path& out);

/// Where the pictures of several scans go: into a video (.mp4, .gif) by ffmpeg, or into a folder, a
/// PNG file each. Without ffmpeg the folder is named like the video.
class PictureSequence {
 public:
  PictureSequence(const std::filesystem::path& out, double per_s);
  ~PictureSequence();
  PictureSequence(const PictureSequence&) = delete;
  PictureSequence& operator=(const PictureSequence&) = delete;

  void add(const std::string& stem, std::string_view png);

  /// Returns what was made, as a sentence. Throws DataError where ffmpeg failed.
  std::string finish();

 private:
  std::filesystem::path out_, partial_;  ///< of a video; empty for a folder
  std::filesystem::path folder_;
  FILE* ffmpeg_ = nullptr;
  std::size_t pictures_ = 0;
};

}  // namespace mosbench
