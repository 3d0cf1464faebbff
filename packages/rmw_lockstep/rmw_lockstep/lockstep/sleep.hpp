// What all functions that wait share.
#pragma once

#include <time.h>

#include <cstdint>

#include "core.hpp"

namespace lockstep {

// Whether the calling thread sleeps in the hub's time.
inline bool virtual_time() { return core().virtual_time(); }

// Convert a time of any of the computer's clocks to the steady clock (ns).
inline int64_t steady(clockid_t clock, int64_t moment) {
  return clock == CLOCK_REALTIME ? moment - core().epoch() : moment;
}

// Keeps a sleeper in the core's list until the end of the scope, except between `leave` and `enter`.
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

// Note that the thread polled files without waiting and found nothing: see clock.cpp.
void poll_found_nothing();

// Do not count the last reading of the clock: Python made it, and how often it does is random.
void discount_reading();

// Note that the thread has sent something: see clock.cpp.
void discount_readings();

// Wait on a futex for at most `most` of real time. Returns 0 if woken, otherwise the errno of futex(2).
int futex_wait(std::atomic<uint32_t> & word, uint32_t while_it_is, bool shared = false, const timespec * most = nullptr);

}  // namespace lockstep
