// POSIX semaphores, of which Python's locks are made. Posting is glibc's; waiting happens here in simulated time, and
// posts of rclpy's own semaphore are counted (signals.hpp).
//
// The value of a sem_t is its first 32 bits, the number of waiting threads the next 32, and whether it is shared between
// processes the 32 after (glibc, sysdeps/nptl/internaltypes.h, `struct new_sem`, since 2.21 on 64-bit machines).
#include <errno.h>
#include <semaphore.h>

#include "real.hpp"
#include "signals.hpp"
#include "sleep.hpp"

namespace lockstep {
namespace {

struct Semaphore {
  std::atomic<uint32_t> value, waiting;
  int is_shared;
};
static_assert(sizeof(Semaphore) <= sizeof(sem_t) && sizeof(void *) == 8, "this is not the sem_t that is known here");

bool known_layout() {
  static const bool known = [] {
    sem_t probe;
    sem_init(&probe, 0, 3);
    const auto & semaphore = reinterpret_cast<Semaphore &>(probe);
    const bool same = semaphore.value == 3 && semaphore.waiting == 0 && semaphore.is_shared == 0;
    sem_destroy(&probe);
    return same;
  }();
  return known;
}

// Returns 0, ETIMEDOUT or EINTR.
int wait_for(sem_t * semaphore, int64_t deadline) {
  if (real::sem_trywait()(semaphore) == 0) return 0;
  if (deadline <= core().now()) return ETIMEDOUT;
  auto & inside = reinterpret_cast<Semaphore &>(*semaphore);
  Sleeper sleeper;
  sleeper.deadline = deadline;
  sleeper.semaphore = &inside.value;
  sleeper.semaphore_shared = inside.is_shared != 0;
  ++inside.waiting;
  int result = -1;
  {
    SleepScope asleep(sleeper);
    while (result < 0) {
      if (sleeper.awake) {
        result = sleeper.due ? ETIMEDOUT : EINTR;
      } else if (inside.value == 0) {
        if (futex_wait(inside.value, 0, sleeper.semaphore_shared) == EINTR) result = EINTR;
      } else {
        asleep.leave();  // before the semaphore is taken: it must not look taken with this thread asleep
        if (real::sem_trywait()(semaphore) == 0) result = 0;
        else asleep.enter();
      }
    }
  }
  --inside.waiting;
  return result;
}

int answer(int fault) {
  if (fault) errno = fault;
  return fault ? -1 : 0;
}

bool here() { return virtual_time() && known_layout(); }

}  // namespace
}  // namespace lockstep

using namespace lockstep;

extern "C" {

LOCKSTEP_API int sem_wait(sem_t * semaphore) {
  signals().waits(semaphore, __builtin_return_address(0));
  const int result = here() ? answer(wait_for(semaphore, NEVER)) : real::sem_wait()(semaphore);
  if (result == 0) signals().got(semaphore);
  return result;
}

LOCKSTEP_API int sem_post(sem_t * semaphore) {
  signals().posts(semaphore);
  return real::sem_post()(semaphore);
}

LOCKSTEP_API int sem_timedwait(sem_t * semaphore, const timespec * until) {
  if (!here()) return real::sem_timedwait()(semaphore, until);
  return answer(wait_for(semaphore, steady(CLOCK_REALTIME, real::nanoseconds(*until))));
}

LOCKSTEP_API int sem_clockwait(sem_t * semaphore, clockid_t clock, const timespec * until) {
  if (here()) return answer(wait_for(semaphore, steady(clock, real::nanoseconds(*until))));
  if (real::clocked_sem_wait()) return real::clocked_sem_wait()(semaphore, clock, until);
  const int64_t left = real::nanoseconds(*until) - real::now(clock);
  const timespec calendar = real::as_timespec(real::now(CLOCK_REALTIME) + left);
  return real::sem_timedwait()(semaphore, &calendar);
}

}  // extern "C"
