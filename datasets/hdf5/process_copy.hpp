#pragma once

#include <functional>
#include <string>

namespace mosbench {

/// What became of work in a copy of this process.
struct CopyAnswer {
  std::string bytes;
  std::string failure;  ///< empty, or how the copy ended instead of answering
};

/// Does work in a copy of this process (fork) and returns its bytes. A damaged file may make a
/// library crash there, or never come back, without harm here: the copy ends after `most_cpu_s` of
/// computing or three times as long of waiting. An exception of `work` comes back as failure.
/// `work` must not start threads or wait for locks that other threads of this process hold.
CopyAnswer in_process_copy(const std::function<std::string()>& work, unsigned most_cpu_s = 60);

}  // namespace mosbench
