// What lockstep.h offers to whoever speaks over the connection.
#include <errno.h>

#include "poll_loop.hpp"
#include "real.hpp"
#include "signals.hpp"
#include "sleep.hpp"

using namespace lockstep;

extern "C" {

LOCKSTEP_API int lockstep_connected() { return core().connected(); }
LOCKSTEP_API int lockstep_virtual() { return core().virtual_time(); }
LOCKSTEP_API uint32_t lockstep_process() { return core().process(); }
LOCKSTEP_API void lockstep_lock() { core().lock(); }
LOCKSTEP_API void lockstep_unlock() { core().unlock(); }
LOCKSTEP_API void lockstep_participate(const lockstep_participant * participant) { core().participate(participant); }
LOCKSTEP_API void lockstep_send(const uint8_t * frame, size_t size) { core().report(frame, size); }
LOCKSTEP_API lockstep_moment lockstep_here() { return core().here(); }
LOCKSTEP_API void lockstep_sent_output() { core().sent_output(); }
LOCKSTEP_API void lockstep_sent() { discount_readings(); }
LOCKSTEP_API void lockstep_settle_signals() { signals().settle(); }
LOCKSTEP_API uint64_t lockstep_sleeps() { return sleeps; }
LOCKSTEP_API void lockstep_polled(int fruitless) { poll_loop.poll(fruitless); }

LOCKSTEP_API int64_t lockstep_now() { return virtual_time() ? core().now() : real::now(CLOCK_MONOTONIC); }

LOCKSTEP_API int64_t lockstep_calendar() {
  return virtual_time() ? core().now() + core().epoch() : real::now(CLOCK_REALTIME);
}

LOCKSTEP_API void lockstep_call_later(void (*function)(const void *, size_t), const void * data, size_t count) {
  core().call_later(function, data, count);
}

LOCKSTEP_API int lockstep_wait(lockstep_waiter * waiter, int64_t deadline) {
  Sleeper sleeper;
  sleeper.deadline = virtual_time() ? deadline : NEVER;
  waiter->sleeper = &sleeper;
  waiter->woken = 0;
  core().fall_asleep(sleeper);
  core().unlock();
  while (!sleeper.awake) {
    const int64_t left = virtual_time() || deadline == NEVER ? NEVER : deadline - real::now(CLOCK_MONOTONIC);
    if (left <= 0) break;
    const timespec slice = real::as_timespec(left);
    futex_wait(sleeper.awake, 0, false, left == NEVER ? nullptr : &slice);
  }
  core().lock();
  core().wake_up(sleeper);
  waiter->sleeper = nullptr;
  return waiter->woken;
}

LOCKSTEP_API void lockstep_wake(lockstep_waiter * waiter) {
  if (!waiter->sleeper) return;
  waiter->woken = 1;
  core().wake(*static_cast<Sleeper *>(waiter->sleeper), false);
}

LOCKSTEP_API void lockstep_block_until(const volatile int * done) {
  ++core().awaited;
  core().poke();
  while (!*done && core().connected()) {
    core().unlock();
    const timespec moment{0, 50'000};
    real::clock_nanosleep()(CLOCK_MONOTONIC, 0, &moment, nullptr);
    core().lock();
  }
  --core().awaited;
}

}  // extern "C"
