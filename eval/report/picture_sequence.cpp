#include "eval/report/picture_sequence.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

bool has_ffmpeg() { return std::system("command -v ffmpeg >/dev/null 2>&1") == 0; }

std::string extension_of(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

/// Videos that every player shows have an even size; a gif has colours of its own.
std::string ffmpeg_command(const std::string& pictures, const std::filesystem::path& file,
                           double per_s) {
  const bool gif = extension_of(file) == ".gif";
  const char* picture = gif ? "-filter_complex '[0:v]split[a][b];[a]palettegen[p];[b][p]paletteuse'"
                            : "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p";
  return fmt::format("ffmpeg -loglevel error -y -framerate {:g} {} {} {}", per_s, pictures, picture,
                     shell_word(file.string()));
}

}  // namespace

bool is_video(const std::filesystem::path& out) {
  return extension_of(out) == ".mp4" || extension_of(out) == ".gif";
}

PictureSequence::PictureSequence(const std::filesystem::path& out, double per_s) : folder_(out) {
  if (!is_video(out)) return;
  if (!has_ffmpeg()) {
    folder_.replace_extension();
    const std::string all = "-pattern_type glob -i " + shell_word((folder_ / "*.png").string());
    tell(
        fmt::format("ffmpeg is not there (Debian's package ffmpeg): pictures go to {} instead, of "
                    "which it makes the video by\n  {}",
                    folder_.string(), ffmpeg_command(all, out, per_s)));
    return;
  }
  out_ = std::filesystem::absolute(out);
  std::filesystem::create_directories(out_.parent_path());
  partial_ = out_.parent_path() /
             fmt::format("{}.partial{}", out_.stem().string(), out_.extension().string());
  ffmpeg_ = popen(ffmpeg_command("-f image2pipe -i -", partial_, per_s).c_str(), "w");
  if (ffmpeg_ == nullptr) throw DataError(out, "ffmpeg cannot be started", "room for a process");
}

PictureSequence::~PictureSequence() {
  if (ffmpeg_ != nullptr) pclose(ffmpeg_);
  std::error_code ignored;
  if (!partial_.empty()) std::filesystem::remove(partial_, ignored);
}

void PictureSequence::add(const std::string& stem, std::string_view png) {
  ++pictures_;
  if (ffmpeg_ == nullptr) return write_file_atomic(folder_ / (stem + ".png"), png);
  // What ffmpeg thinks of it shows when it ends.
  std::fwrite(png.data(), 1, png.size(), ffmpeg_);
}

std::string PictureSequence::finish() {
  if (ffmpeg_ == nullptr) return fmt::format("{} pictures in {}\n", pictures_, folder_.string());
  if (pclose(std::exchange(ffmpeg_, nullptr)) != 0) {
    throw DataError(out_, "could not be made by ffmpeg", "that it takes PNG files and knows H.264");
  }
  std::filesystem::rename(partial_, out_);
  return fmt::format("{} pictures in the video {}\n", pictures_, out_.string());
}

}  // namespace mosbench
