// The computer's clocks, which show the hub's time.
#include <errno.h>

#include <algorithm>

#include "poll_loop.hpp"
#include "real.hpp"
#include "sleep.hpp"

namespace lockstep {
namespace {

// A thread that reads the clock this often without ever waiting is in a busy wait for a time. From then on it sleeps
// TIME_PER_READINGS (ns) after every READINGS readings. Python reads the clock for each lock that it takes, so many
// readings are free, and each message that the thread sends adds READINGS more: it does more than wait for a time.
constexpr unsigned FREE_READINGS = 100'000, READINGS = 1'000;
constexpr int64_t TIME_PER_READINGS = 1'000'000;

thread_local unsigned readings = 0;
thread_local uint64_t sleeps_before = 0;

void count_reading() {
  if (reads_clock_freely) return;
  if (sleeps_before != sleeps) { sleeps_before = sleeps; readings = 0; }
  if (++readings < FREE_READINGS || readings % READINGS) return;
  reads_clock_freely = true;
  sleep_until(core().now() + TIME_PER_READINGS, true);
  reads_clock_freely = false;
  sleeps_before = sleeps;  // this sleep is not one of the program's
}

// A thread that polls files again and again at one moment, without waiting, sees 1 ns pass with each poll, as it would
// with a real clock. Python's `Connection.poll()` returns only when the time is later than when it began; otherwise it
// would use up its free readings of the clock. The first polls are free, as asyncio makes several at each moment.
constexpr unsigned FREE_LOOKS = 100, MOST_LOOKS = 500'000;

thread_local int64_t looked_at = -1;
thread_local unsigned looks = 0;

int64_t passed_while_looking() { return looked_at == core().now() && looks > FREE_LOOKS ? looks - FREE_LOOKS : 0; }

bool of_cpu(clockid_t clock) {
  // CPU time clocks of other processes and threads have negative numbers.
  return clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID || clock < 0;
}

int64_t moment(clockid_t clock) {
  count_reading();
  const bool calendar = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI;
  return core().now() + passed_while_looking() + (calendar ? core().epoch() : 0);
}

constexpr int OK = 0, INVALID_ARGUMENT = 11;  // of rcutils/types/rcutils_ret.h

int read_for_ros(clockid_t clock, int64_t * now) {
  if (!now) return INVALID_ARGUMENT;
  poll_loop.forget();
  *now = virtual_time() ? moment(clock) : real::now(clock);
  return OK;
}

}  // namespace

void discount_reading() { if (readings) --readings; }
void discount_readings() { readings -= std::min(readings, READINGS); }

void poll_found_nothing() {
  if (looked_at != core().now()) { looked_at = core().now(); looks = 0; }
  if (looks < MOST_LOOKS) ++looks;
}

}  // namespace lockstep

using namespace lockstep;

extern "C" {

LOCKSTEP_API int clock_gettime(clockid_t clock, timespec * time) {
  if (!virtual_time() || of_cpu(clock)) return real::clock_gettime()(clock, time);
  *time = real::as_timespec(moment(clock));
  return 0;
}

LOCKSTEP_API int timespec_get(timespec * time, int base) {
  if (base != TIME_UTC) return 0;
  ::clock_gettime(CLOCK_REALTIME, time);
  return base;
}

LOCKSTEP_API int gettimeofday(timeval * time, void * zone) {
  if (!virtual_time()) return real::gettimeofday()(time, zone);
  const int64_t microseconds = moment(CLOCK_REALTIME) / 1000;
  *time = {microseconds / 1'000'000, static_cast<suseconds_t>(microseconds % 1'000'000)};
  return 0;
}

LOCKSTEP_API time_t time(time_t * out) {
  if (!virtual_time()) return real::time()(out);
  const time_t seconds = moment(CLOCK_REALTIME) / 1'000'000'000;
  if (out) *out = seconds;
  return seconds;
}

// ROS 2's own (rcutils/time.h). While it polls, it calls this only for a timer.
LOCKSTEP_API int rcutils_steady_time_now(int64_t * now) { return read_for_ros(CLOCK_MONOTONIC, now); }
LOCKSTEP_API int rcutils_system_time_now(int64_t * now) { return read_for_ros(CLOCK_REALTIME, now); }

}  // extern "C"
