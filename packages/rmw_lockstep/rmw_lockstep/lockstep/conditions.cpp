// Condition variables with a time-out: C++'s, and the one by which Python's threads wait for its global lock.
#include <errno.h>
#include <link.h>

#include <algorithm>

#include "real.hpp"
#include "sleep.hpp"

namespace lockstep {
namespace {

// A thread of Python asks for the GIL every 5 ms of real time until its holder releases it. Here it asks after the same
// CPU time of the process (ns), so that a busy machine does not change which thread runs next.
constexpr int64_t LOOK = 5'000'000, SWITCH = 20'000'000;

struct Range {
  uintptr_t begin = 0, end = 0;
  bool holds(const void * address) const {
    const auto at = reinterpret_cast<uintptr_t>(address);
    return begin <= at && at < end;
  }
};

// The file (python3 or libpython3.so) that contains the interpreter; empty in a program without Python.
Range find_python() {
  Range range;
  const void * inside = dlsym(RTLD_DEFAULT, "PyEval_RestoreThread");
  Dl_info info;
  if (!inside || !dladdr(inside, &info)) return range;
  range.begin = reinterpret_cast<uintptr_t>(info.dli_fbase);
  dl_iterate_phdr([](dl_phdr_info * object, size_t, void * data) {
    auto & found = *static_cast<Range *>(data);
    uintptr_t low = UINTPTR_MAX, high = 0;
    for (int i = 0; i < object->dlpi_phnum; ++i) {
      const auto & part = object->dlpi_phdr[i];
      if (part.p_type != PT_LOAD) continue;
      low = std::min<uintptr_t>(low, object->dlpi_addr + part.p_vaddr);
      high = std::max<uintptr_t>(high, object->dlpi_addr + part.p_vaddr + part.p_memsz);
    }
    if (low <= found.begin && found.begin < high) { found = {low, high}; return 1; }
    return 0;
  }, &range);
  return range;
}

bool is_python(const void * caller) {
  static const Range python = find_python();
  return python.holds(caller);
}

int wait_really(pthread_cond_t * condition, pthread_mutex_t * mutex, int64_t for_ns) {
  if (real::pthread_cond_clockwait()) {
    const timespec until = real::as_timespec(real::now(CLOCK_MONOTONIC) + for_ns);
    return real::pthread_cond_clockwait()(condition, mutex, CLOCK_MONOTONIC, &until);
  }
  const timespec until = real::as_timespec(real::now(CLOCK_MONOTONIC) + for_ns);  // Python's own are of this clock
  return real::pthread_cond_timedwait()(condition, mutex, &until);
}

int wait_for_python(pthread_cond_t * condition, pthread_mutex_t * mutex) {
  discount_reading();  // by which Python found out how long to wait
  const int64_t begin = real::now(CLOCK_PROCESS_CPUTIME_ID);
  const pid_t thread = thread_number();
  core().contenders.add(thread);
  int result;
  do result = wait_really(condition, mutex, LOOK);
  while (result == ETIMEDOUT && real::now(CLOCK_PROCESS_CPUTIME_ID) - begin < SWITCH);
  core().contenders.remove(thread);
  return result;
}

int wait_until(pthread_cond_t * condition, pthread_mutex_t * mutex, int64_t deadline) {
  if (deadline <= core().now()) return ETIMEDOUT;
  Sleeper sleeper;
  sleeper.deadline = deadline;
  sleeper.condition = condition;
  SleepScope asleep(sleeper);
  const int result = sleeper.awake ? 0 : real::pthread_cond_wait()(condition, mutex);
  return result == 0 && sleeper.awake && sleeper.due ? ETIMEDOUT : result;
}

// pthread_cond_t keeps its clock in the second bit of `__wrefs` (glibc, nptl/pthread_cond_common.c).
clockid_t clock_of(const pthread_cond_t * condition) {
  return condition->__data.__wrefs & 2 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

}  // namespace
}  // namespace lockstep

using namespace lockstep;

extern "C" {

LOCKSTEP_API int pthread_cond_timedwait(pthread_cond_t * condition, pthread_mutex_t * mutex, const timespec * until) {
  if (!virtual_time()) return real::pthread_cond_timedwait()(condition, mutex, until);
  if (is_python(__builtin_return_address(0))) return wait_for_python(condition, mutex);
  return wait_until(condition, mutex, steady(clock_of(condition), real::nanoseconds(*until)));
}

LOCKSTEP_API int pthread_cond_clockwait(
    pthread_cond_t * condition, pthread_mutex_t * mutex, clockid_t clock, const timespec * until) {
  if (!virtual_time()) {
    if (real::pthread_cond_clockwait()) return real::pthread_cond_clockwait()(condition, mutex, clock, until);
    return EINVAL;
  }
  if (is_python(__builtin_return_address(0))) return wait_for_python(condition, mutex);
  return wait_until(condition, mutex, steady(clock, real::nanoseconds(*until)));
}

}  // extern "C"
