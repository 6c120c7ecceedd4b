#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace mosbench {

/// A folder or file that is being made and appears as a whole, by one rename. Its name until then
/// is this process's alone on every host, so that writers need no locks, which file systems that
/// hosts share may lack. What was not put in place goes with the object.
class Claim {
 public:
  /// `place` is the name to take; makes the folder around it.
  explicit Claim(const std::filesystem::path& place);
  /// The same where a lock keeps others away: `path` is where to write, and what a killed process
  /// left there is removed. Throws DataError.
  Claim(std::filesystem::path place, std::filesystem::path path);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Where to write until `put`.
  const std::filesystem::path& path() const { return path_; }

  /// Puts what was made at `place`; a folder that lies there is replaced. Throws DataError.
  void put();
  /// The same, but leaves what another process has put there meanwhile.
  void put_unless_there();

 private:
  std::filesystem::path place_, path_;
};

/// Replaces `file` as a whole by a Claim. Throws DataError.
void write_shared(const std::filesystem::path& file, std::string_view bytes);

/// Removes what processes of this host that have ended left half-written in a folder.
void remove_abandoned(const std::filesystem::path& folder);

/// Name of this host in its network, as far as it can be read.
std::string host_name();

}  // namespace mosbench
