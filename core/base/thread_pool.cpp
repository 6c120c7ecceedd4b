#include "core/base/thread_pool.hpp"

#include <algorithm>
#include <chrono>
#include <exception>

namespace mosbench {
namespace {

/// Time to spin before blocking. Waking a thread takes about as long, and a scan has some fifteen
/// parallel regions.
constexpr std::chrono::microseconds kWatch{60};

/// Returns when `happened` or a little later; lets other threads run meanwhile.
template <typename Happened>
void watch(Happened&& happened) {
  const auto end = std::chrono::steady_clock::now() + kWatch;
  while (!happened() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

void stop(std::mutex& mutex, std::atomic<bool>& stopped, std::condition_variable& start) {
  {
    const std::lock_guard lock(mutex);
    stopped = true;
  }
  start.notify_all();
}

}  // namespace

unsigned hardware_threads() { return std::max(1U, std::thread::hardware_concurrency()); }

struct ThreadPool::Job {
  std::size_t count, grain;
  const std::function<void(std::size_t, std::size_t, unsigned)>& work;
  std::atomic<std::size_t> next{0};
  std::mutex error_mutex{};
  std::exception_ptr error{};
  std::size_t error_begin = 0;

  void drain(unsigned thread) {
    std::size_t begin = 0;
    try {
      for (begin = next.fetch_add(grain); begin < count; begin = next.fetch_add(grain)) {
        work(begin, std::min(begin + grain, count), thread);
      }
    } catch (...) {
      next = count;
      // Ranges start in order, so the lowest that throws has started before any error stops the
      // rest.
      const std::lock_guard lock(error_mutex);
      if (error && error_begin < begin) return;
      error = std::current_exception();
      error_begin = begin;
    }
  }
};

ThreadPool::ThreadPool(unsigned threads) {
  try {
    for (unsigned thread = 1; thread < threads; ++thread) {
      workers_.emplace_back([this, thread] { serve(thread); });
    }
  } catch (...) {
    stop(mutex_, stop_, start_);  // or they would be waited for without end
    throw;
  }
}

ThreadPool::~ThreadPool() { stop(mutex_, stop_, start_); }

void ThreadPool::for_ranges(std::size_t count, std::size_t grain,
                            const std::function<void(std::size_t, std::size_t, unsigned)>& work) {
  Job job{.count = count, .grain = std::max<std::size_t>(grain, 1), .work = work};
  if (workers_.empty() || count <= grain) {
    job.drain(0);
  } else {
    {
      const std::lock_guard lock(mutex_);
      job_ = &job;
      ++generation_;
    }
    start_.notify_all();
    job.drain(0);
    watch([this] { return busy_ == 0; });
    std::unique_lock lock(mutex_);
    job_ = nullptr;  // a thread that wakes only now has nothing left to do and is not waited for
    finish_.wait(lock, [this] { return busy_ == 0; });
  }
  if (job.error) std::rethrow_exception(job.error);
}

void ThreadPool::serve(unsigned thread) {
  std::size_t served = 0;
  for (;;) {
    Job* job = nullptr;
    watch([&] { return stop_ || generation_ != served; });
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || generation_ != served; });
      if (stop_) return;
      served = generation_;
      job = job_;
      if (job == nullptr) continue;
      ++busy_;
    }
    job->drain(thread);
    {
      const std::lock_guard lock(mutex_);
      if (--busy_ == 0) finish_.notify_one();
    }
  }
}

}  // namespace mosbench
