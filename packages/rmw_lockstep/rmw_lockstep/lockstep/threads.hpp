// The threads of this process, as the kernel sees them.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lockstep {

class Threads {
public:
  enum class Look {
    asleep,   // every one sleeps, in a call that only another thread can end
    timed,    // the same, but one of them waits for a time by the kernel's own clock
    busy,     // one runs, or is runnable
  };

  // How many there are, the calling one included.
  unsigned count();
  // Check every thread except those in `known`, which are known to sleep. `children`: whether the process has any.
  Look look(const std::vector<pid_t> & known, bool children);
  // A number that differs from the last one if any thread except `listener` has run since.
  uint64_t runs(pid_t listener);
  void forget();

private:
  struct Thread { int stat, schedule, call; std::string before; };
  void read();
  bool open_thread(pid_t number);
  void close_all();

  int folder_ = -1;
  unsigned links_ = 0;
  bool complete_ = false;  // whether every thread is in `threads_`
  std::map<pid_t, Thread> threads_;
};

// Threads of Python that wait for its global lock, and run as soon as its holder releases it. They come and go with each
// switch between threads, so they take no lock for it.
class Contenders {
public:
  void add(pid_t thread);
  void remove(pid_t thread);
  int count() const { return count_; }
  // Those that are known by number: all but the rest of very many.
  void append_to(std::vector<pid_t> & threads) const;
  void forget();

private:
  std::atomic<int> count_{0};
  std::atomic<pid_t> places_[64] = {};
};

}  // namespace lockstep
