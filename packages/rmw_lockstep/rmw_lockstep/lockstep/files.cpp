// poll(2), select(2) and epoll_wait(2) with a time-out.
//
// Each thread polls an eventfd together with the program's files. It wakes the thread at its deadline.
#include <errno.h>
#include <sys/eventfd.h>

#include <vector>

#include "real.hpp"
#include "sleep.hpp"

namespace lockstep {
namespace {

struct Event {
  int file = -1;
  pid_t process = 0;
  ~Event() { if (file >= 0 && process == getpid()) close(file); }
  int get() {
    if (process != getpid()) { file = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC); process = getpid(); }
    return file;
  }
  void clear() { uint64_t count; (void)!read(file, &count, sizeof count); }
};
thread_local Event event;

// Poll until a file is ready or the steady clock shows `deadline`. As ppoll(2).
int poll_until(const pollfd * files, nfds_t count, int64_t deadline, const sigset_t * mask, std::vector<pollfd> & out) {
  out.assign(files, files + count);
  const timespec now{0, 0};
  const int ready = real::ppoll()(out.data(), count, &now, mask);
  if (ready) return ready;
  if (deadline <= core().now()) { poll_found_nothing(); return 0; }
  out.push_back({event.get(), POLLIN, 0});
  Sleeper sleeper;
  sleeper.deadline = deadline;
  sleeper.period = deadline - core().now();
  sleeper.event = event.get();
  sleeper.files = files;
  sleeper.file_count = count;
  int found, fault;
  {
    SleepScope asleep(sleeper);
    found = real::ppoll()(out.data(), out.size(), nullptr, mask);
    fault = errno;
  }
  if (sleeper.awake) event.clear();
  if (found < 0) errno = fault;
  if (found > 0 && out.back().revents && --found == 0 && sleeper.interrupted) { errno = EINTR; found = -1; }
  out.pop_back();
  return found;
}

// Return what the real call found. `waits`: it would have waited until there was something.
int without_waiting(int found, bool waits) {
  if (virtual_time() && found == 0 && !waits) poll_found_nothing();
  return found;
}

int64_t after(int milliseconds) { return core().now() + milliseconds * 1'000'000LL; }

int take(const std::vector<pollfd> & files, fd_set * set, short events) {
  int found = 0;
  if (!set) return 0;
  FD_ZERO(set);
  for (const pollfd & file : files)
    if (file.revents & events) { FD_SET(file.fd, set); ++found; }
  return found;
}

constexpr short CAN_READ = POLLIN | POLLHUP | POLLERR, CAN_WRITE = POLLOUT | POLLERR, IS_SPECIAL = POLLPRI;

int select_until(int count, fd_set * reads, fd_set * writes, fd_set * specials, int64_t deadline, const sigset_t * mask) {
  if (!count || (!reads && !writes && !specials)) {
    const int fault = deadline > core().now() ? sleep_until(deadline) : 0;
    if (fault) errno = fault;
    return fault ? -1 : 0;
  }
  std::vector<pollfd> files, out;
  for (int file = 0; file < count; ++file) {
    short events = 0;
    if (reads && FD_ISSET(file, reads)) events |= POLLIN;
    if (writes && FD_ISSET(file, writes)) events |= POLLOUT;
    if (specials && FD_ISSET(file, specials)) events |= POLLPRI;
    if (events) files.push_back({file, events, 0});
  }
  if (poll_until(files.data(), files.size(), deadline, mask, out) < 0) return -1;
  for (const pollfd & file : out) if (file.revents & POLLNVAL) { errno = EBADF; return -1; }
  return take(out, reads, CAN_READ) + take(out, writes, CAN_WRITE) + take(out, specials, IS_SPECIAL);
}

}  // namespace
}  // namespace lockstep

using namespace lockstep;

extern "C" {

LOCKSTEP_API int poll(pollfd * files, nfds_t count, int timeout) {
  if (!virtual_time() || timeout <= 0) return without_waiting(real::poll()(files, count, timeout), timeout);
  std::vector<pollfd> out;
  const int found = poll_until(files, count, after(timeout), nullptr, out);
  for (nfds_t i = 0; found >= 0 && i < count; ++i) files[i].revents = out[i].revents;
  return found;
}

LOCKSTEP_API int ppoll(pollfd * files, nfds_t count, const timespec * timeout, const sigset_t * mask) {
  if (!virtual_time() || !timeout) return real::ppoll()(files, count, timeout, mask);
  std::vector<pollfd> out;
  const int found = poll_until(files, count, core().now() + real::nanoseconds(*timeout), mask, out);
  for (nfds_t i = 0; found >= 0 && i < count; ++i) files[i].revents = out[i].revents;
  return found;
}

LOCKSTEP_API int select(int count, fd_set * reads, fd_set * writes, fd_set * specials, timeval * timeout) {
  const int64_t time = timeout ? timeout->tv_sec * 1'000'000'000LL + timeout->tv_usec * 1'000LL : 0;
  if (!virtual_time() || !timeout || time <= 0)
    return without_waiting(real::select()(count, reads, writes, specials, timeout), !timeout);
  return select_until(count, reads, writes, specials, core().now() + time, nullptr);
}

LOCKSTEP_API int pselect(
    int count, fd_set * reads, fd_set * writes, fd_set * specials, const timespec * timeout, const sigset_t * mask) {
  if (!virtual_time() || !timeout) return real::pselect()(count, reads, writes, specials, timeout, mask);
  return select_until(count, reads, writes, specials, core().now() + real::nanoseconds(*timeout), mask);
}

LOCKSTEP_API int epoll_pwait(int file, epoll_event * events, int most, int timeout, const sigset_t * mask) {
  if (!virtual_time() || timeout <= 0)
    return without_waiting(real::epoll_pwait()(file, events, most, timeout, mask), timeout);
  const pollfd files[1] = {{file, POLLIN, 0}};
  std::vector<pollfd> out;
  if (poll_until(files, 1, after(timeout), mask, out) < 0) return -1;
  return real::epoll_pwait()(file, events, most, 0, mask);
}

LOCKSTEP_API int epoll_wait(int file, epoll_event * events, int most, int timeout) {
  return ::epoll_pwait(file, events, most, timeout, nullptr);
}

}  // extern "C"
