#include "threads.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace lockstep {
namespace {

const char * FOLDER = "/proc/self/task";

int open_file(pid_t thread, const char * name) {
  char path[80];
  snprintf(path, sizeof path, "%s/%d/%s", FOLDER, thread, name);
  return open(path, O_RDONLY | O_CLOEXEC);
}

// The text of a file that stays open; empty when its thread has ended.
std::string text_of(int file) {
  char text[512];
  const ssize_t size = pread(file, text, sizeof text, 0);
  return size > 0 ? std::string(text, size) : std::string();
}

// The state, such as R or S. It follows the program's name, which may hold any character but ends with the last bracket.
char state_of(int stat) {
  const std::string text = text_of(stat);
  const size_t bracket = text.rfind(')');
  return bracket == std::string::npos || bracket + 2 >= text.size() ? 0 : text[bracket + 2];
}

struct Call {
  long number = -1;
  unsigned long argument[6] = {};
};

enum class Sleeps { in_call, elsewhere, no_more };

// proc_pid_syscall(5): the number and six arguments; -1 outside of a call; or "running" as soon as it is to run again.
Sleeps read_call(int file, Call & call) {
  const std::string text = text_of(file);
  if (text.compare(0, 7, "running") == 0) return Sleeps::no_more;
  const int found = sscanf(
    text.c_str(), "%ld %lx %lx %lx %lx %lx %lx", &call.number, &call.argument[0], &call.argument[1], &call.argument[2],
    &call.argument[3], &call.argument[4], &call.argument[5]);
  return found == 7 ? Sleeps::in_call : Sleeps::elsewhere;
}

bool negative(unsigned long timeout) { return static_cast<int>(timeout) < 0; }

// Whether a thread that sleeps in this call sleeps until another one wakes it, and not until a time.
bool without_timeout(const Call & call, bool children) {
  switch (call.number) {
    case SYS_futex: return call.argument[3] == 0;
#ifdef SYS_futex_waitv
    case SYS_futex_waitv: return call.argument[3] == 0;
#endif
    case SYS_ppoll: return call.argument[2] == 0;
    case SYS_pselect6: return call.argument[4] == 0;
    case SYS_epoll_pwait: return negative(call.argument[3]);
#ifdef SYS_epoll_pwait2
    case SYS_epoll_pwait2: return call.argument[3] == 0;
#endif
    case SYS_rt_sigtimedwait: return call.argument[2] == 0;
    // A child that this library does not know may wait for anything.
    case SYS_wait4: case SYS_waitid: return children;
    case SYS_read: case SYS_readv: case SYS_recvfrom: case SYS_recvmsg: case SYS_accept: case SYS_accept4:
    case SYS_rt_sigsuspend: case SYS_flock: case SYS_fcntl: return true;
#ifdef __x86_64__
    case SYS_poll: return negative(call.argument[2]);
    case SYS_select: return call.argument[4] == 0;
    case SYS_epoll_wait: return negative(call.argument[3]);
    case SYS_pause: return true;
#endif
    default: return false;
  }
}

}  // namespace

unsigned Threads::count() {
  if (folder_ < 0) folder_ = open(FOLDER, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  struct stat folder;
  // Not fstat, which is a function of its own only from glibc 2.33 on.
  if (folder_ < 0 || syscall(SYS_fstat, folder_, &folder) != 0) return 0;
  // Linux counts two links, and one for each thread. If that does not hold, the folder is read each time.
  if (folder.st_nlink > 2) {
    if (folder.st_nlink != links_) { links_ = folder.st_nlink; read(); }
    return links_ - 2;
  }
  read();
  return threads_.size();
}

void Threads::read() {
  std::vector<pid_t> there;
  DIR * const folder = opendir(FOLDER);
  complete_ = folder != nullptr;
  if (!folder) { links_ = 0; return; }
  while (const dirent * entry = readdir(folder))
    if (const pid_t number = atoi(entry->d_name)) there.push_back(number);
  closedir(folder);
  for (auto it = threads_.begin(); it != threads_.end();) {
    const bool gone = std::find(there.begin(), there.end(), it->first) == there.end();
    if (gone) { close(it->second.stat); close(it->second.schedule); close(it->second.call); it = threads_.erase(it); }
    else ++it;
  }
  for (const pid_t number : there)
    if (!threads_.count(number) && !open_thread(number)) { links_ = 0; complete_ = false; }
}

bool Threads::open_thread(pid_t number) {
  Thread thread{open_file(number, "stat"), open_file(number, "schedstat"), open_file(number, "syscall"), {}};
  if (thread.stat < 0 || thread.schedule < 0) {
    for (const int file : {thread.stat, thread.schedule, thread.call}) if (file >= 0) close(file);
    return false;
  }
  threads_[number] = std::move(thread);
  return true;
}

// Read the CPU time of each thread twice, and its state in between. If none ran, all slept at the same moment.
Threads::Look Threads::look(const std::vector<pid_t> & known, bool children) {
  // A thread that has ended meanwhile is missing when they are read again. The program may also have no files left.
  if (!complete_) return Look::busy;
  auto skipped = [&](pid_t number) { return std::find(known.begin(), known.end(), number) != known.end(); };
  for (auto & [number, thread] : threads_)
    if (!skipped(number) && (thread.before = text_of(thread.schedule)).empty()) { links_ = 0; return Look::busy; }
  for (auto & [number, thread] : threads_)
    if (!skipped(number)) {
      const char state = state_of(thread.stat);
      if (!state) links_ = 0;  // it has ended; another may have begun, which the number of links does not show
      if (state != 'S') return Look::busy;
    }
  // All sleep now. A thread that was begun after they were listed, and has not run yet, may be what they wait for.
  const size_t listed = threads_.size();
  if (count() != listed || !complete_) return Look::busy;
  bool timed = false;
  for (auto & [number, thread] : threads_) {
    if (skipped(number)) continue;
    Call call;
    const Sleeps sleeps = thread.call >= 0 ? read_call(thread.call, call) : Sleeps::elsewhere;
    // A thread whose deadline has passed is waiting for a CPU.
    if (sleeps == Sleeps::no_more) return Look::busy;
    if (sleeps == Sleeps::in_call) timed |= !without_timeout(call, children);
    if (text_of(thread.schedule) != thread.before) return Look::busy;
  }
  return timed ? Look::timed : Look::asleep;
}

// schedstat's third number is how often a thread was given a CPU (Documentation/scheduler/sched-stats.rst).
uint64_t Threads::runs(pid_t listener) {
  uint64_t total = count();
  for (const auto & [number, thread] : threads_) {
    unsigned long long on_cpu = 0, waited = 0, times = 0;
    if (number == listener) continue;
    sscanf(text_of(thread.schedule).c_str(), "%llu %llu %llu", &on_cpu, &waited, &times);
    total += static_cast<uint64_t>(number) + times;
  }
  return total;
}

void Threads::close_all() {
  for (auto & [_, thread] : threads_) { close(thread.stat); close(thread.schedule); if (thread.call >= 0) close(thread.call); }
  threads_.clear();
}

void Contenders::add(pid_t thread) {
  ++count_;
  for (auto & place : places_) {
    pid_t free = 0;
    if (place.compare_exchange_strong(free, thread)) return;
  }
}

void Contenders::remove(pid_t thread) {
  for (auto & place : places_) {
    pid_t own = thread;
    if (place.compare_exchange_strong(own, 0)) break;
  }
  --count_;
}

void Contenders::append_to(std::vector<pid_t> & threads) const {
  for (const auto & place : places_)
    if (const pid_t thread = place) threads.push_back(thread);
}

void Contenders::forget() {
  count_ = 0;
  for (auto & place : places_) place = 0;
}

void Threads::forget() {
  close_all();
  if (folder_ >= 0) close(folder_);
  folder_ = -1;
  links_ = 0;
}

}  // namespace lockstep
