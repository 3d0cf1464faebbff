// Which of a program's threads goes on first after a signal.
#include "signals.hpp"

#include <limits.h>
#include <linux/futex.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "real.hpp"
#include "sleep.hpp"

namespace lockstep {
namespace {

// Whether the code at an address is rclpy's extension module.
bool is_rclpy(const void * caller) {
  static thread_local const void * last = nullptr;
  static thread_local bool answer = false;
  if (caller == last) return answer;
  Dl_info info;
  const char * const path = dladdr(caller, &info) ? info.dli_fname : nullptr;
  const char * const slash = path ? strrchr(path, '/') : nullptr;
  last = caller;
  return answer = slash && strncmp(slash, "/_rclpy", 7) == 0;
}

// Of rclpy's thread only.
struct End { bool is_due = false; ~End() { if (is_due) signals().forget(); } };
thread_local End end;

}  // namespace

Signals & signals() {
  static Signals * const only = new Signals;
  return *only;
}

void Signals::waits(sem_t * semaphore, const void * caller) {
  if (!is_rclpy(caller)) return;
  if (thread_ != thread_number()) begin(semaphore);
  handled(taken_);
}

void Signals::begin(sem_t * semaphore) {
  int untaken = 0;
  end.is_due = true;
  thread_ = thread_number();
  semaphore_ = semaphore;
  sem_getvalue(semaphore, &untaken);
  taken_ = arrived_ - static_cast<uint32_t>(untaken);
}

void Signals::got(sem_t * semaphore) {
  if (semaphore == semaphore_ && thread_ == thread_number()) ++taken_;
}

void Signals::posts(sem_t * semaphore) {
  if (semaphore != semaphore_) return;
  ++arrived_;
  core().interrupt();
}

void Signals::settle() {
  if (!pending() || !virtual_time() || thread_ == thread_number()) return;
  ++settling_;
  core().lock();
  core().check_again();
  core().unlock();
  for (uint32_t seen = handled_; pending(); seen = handled_) futex_wait(handled_, seen);
  --settling_;
}

bool Signals::give_up() {
  if (!settling_ || !pending()) return false;
  handled(arrived_);
  return true;
}

void Signals::forget() {
  semaphore_ = nullptr;
  thread_ = 0;
  handled(arrived_);
}

void Signals::handled(uint32_t count) {
  if (handled_.exchange(count) == count) return;
  syscall(SYS_futex, &handled_, FUTEX_WAKE | FUTEX_PRIVATE_FLAG, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace lockstep
