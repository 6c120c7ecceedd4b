#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace mosbench {

/// Returns the logical cores of the machine; 1 when unknown.
unsigned hardware_threads();

/// Worker threads created once. Work is cut into fixed chunks with disjoint outputs, so results do
/// not depend on which thread computes which chunk.
class ThreadPool {
 public:
  /// `threads` counts the calling thread: 1 starts no worker.
  explicit ThreadPool(unsigned threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned size() const { return static_cast<unsigned>(workers_.size()) + 1; }

  /// Calls work(begin, end, thread) for consecutive ranges of at most `grain` of [0, count), each
  /// exactly once; `thread` is below size(). Returns when all are done. If several calls throw, the
  /// exception of the lowest range is rethrown here. Must not be nested.
  void for_ranges(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t, unsigned)>& work);

 private:
  struct Job;
  void serve(unsigned thread);

  std::mutex mutex_;
  std::condition_variable start_, finish_;
  Job* job_ = nullptr;
  // Written under the mutex, so that no thread misses a change; atomic for those that spin without
  // it.
  std::atomic<std::size_t> generation_ = 0;
  std::atomic<unsigned> busy_ = 0;  // workers at the job
  std::atomic<bool> stop_ = false;
  std::vector<std::jthread> workers_;  // last: joined before the members they use are destroyed
};

}  // namespace mosbench
