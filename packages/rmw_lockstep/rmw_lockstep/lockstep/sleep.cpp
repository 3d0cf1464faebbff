// sleep(3), nanosleep(2) and related functions.
#include "sleep.hpp"

#include <errno.h>
#include <linux/futex.h>
#include <sys/syscall.h>

#include <algorithm>

#include "real.hpp"

namespace lockstep {

int futex_wait(std::atomic<uint32_t> & word, uint32_t while_it_is, bool shared, const timespec * most) {
  const int operation = FUTEX_WAIT | (shared ? 0 : FUTEX_PRIVATE_FLAG);
  return syscall(SYS_futex, &word, operation, while_it_is, most, nullptr, 0) == 0 ? 0 : errno;
}

int sleep_until(int64_t deadline, bool holds_interpreter) {
  Sleeper sleeper;
  sleeper.deadline = deadline;
  sleeper.period = holds_interpreter ? 0 : deadline - core().now();
  sleeper.holds_interpreter = holds_interpreter;
  SleepScope asleep(sleeper);
  while (!sleeper.awake)
    if (futex_wait(sleeper.awake, 0) == EINTR && !sleeper.awake) return EINTR;
  return sleeper.interrupted ? EINTR : 0;
}

}  // namespace lockstep

using namespace lockstep;

extern "C" {

LOCKSTEP_API int clock_nanosleep(clockid_t clock, int flags, const timespec * request, timespec * left) {
  const bool of_cpu = clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID;
  if (!virtual_time() || of_cpu) return real::clock_nanosleep()(clock, flags, request, left);
  if (!request || request->tv_nsec < 0 || request->tv_nsec > 999'999'999 || request->tv_sec < 0) return EINVAL;
  const int64_t time = real::nanoseconds(*request);
  const int64_t deadline = flags & TIMER_ABSTIME ? steady(clock, time) : core().now() + time;
  if (deadline <= core().now()) return 0;
  const int result = sleep_until(deadline);
  if (result && left && !(flags & TIMER_ABSTIME)) *left = real::as_timespec(std::max<int64_t>(0, deadline - core().now()));
  return result;
}

LOCKSTEP_API int nanosleep(const timespec * request, timespec * left) {
  const int fault = ::clock_nanosleep(CLOCK_MONOTONIC, 0, request, left);
  if (fault) errno = fault;
  return fault ? -1 : 0;
}

LOCKSTEP_API int usleep(useconds_t microseconds) {
  const timespec request = real::as_timespec(microseconds * 1'000LL);
  return ::nanosleep(&request, nullptr);
}

LOCKSTEP_API unsigned sleep(unsigned seconds) {
  const timespec request{static_cast<time_t>(seconds), 0};
  timespec left{};
  return ::nanosleep(&request, &left) ? static_cast<unsigned>(left.tv_sec + (left.tv_nsec > 0)) : 0;
}

}  // extern "C"
