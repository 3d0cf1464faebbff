// What the functions that wait have in common.
#pragma once

#include <time.h>

#include <cstdint>

#include "core.hpp"

namespace lockstep {

// Whether the calling thread sleeps in the hub's time.
inline bool virtual_time() { return core().virtual_time(); }

// A moment on any of the computer's clocks, as one on the steady clock (ns).
inline int64_t steady(clockid_t clock, int64_t moment) {
  return clock == CLOCK_REALTIME ? moment - core().epoch() : moment;
}

// Is in the core's list of sleepers for as long as it lives.
class SleepScope {
public:
  explicit SleepScope(Sleeper & sleeper) : sleeper_(sleeper) { enter(); }
  ~SleepScope() { leave(); }
  SleepScope(const SleepScope &) = delete;
  SleepScope & operator=(const SleepScope &) = delete;
  void enter() { if (!in_) { core().lock(); core().fall_asleep(sleeper_); core().unlock(); in_ = true; } }
  void leave() { if (in_) { core().lock(); core().wake_up(sleeper_); core().unlock(); in_ = false; } }

private:
  Sleeper & sleeper_;
  bool in_ = false;
};

// Sleep until the steady clock shows `deadline`. Returns 0, or EINTR if a signal arrived first.
int sleep_until(int64_t deadline, bool holds_interpreter = false);

// The thread has looked at files without waiting, and nothing was there: see clock.cpp.
void poll_found_nothing();

// Discount the last reading of the clock: it was not the program's own, and is random.
void discount_reading();

// The thread has sent something: see clock.cpp.
void discount_readings();

// Wait on a word of memory, at most for a real time; returns what the futex call set errno to, 0 if it woke.
int futex_wait(std::atomic<uint32_t> & word, uint32_t while_it_is, bool shared = false, const timespec * most = nullptr);

}  // namespace lockstep
