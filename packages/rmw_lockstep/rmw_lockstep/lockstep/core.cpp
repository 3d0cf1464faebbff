#include "core.hpp"

#include <errno.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <algorithm>
#include <limits>

#include "bytes.hpp"
#include "poll_loop.hpp"
#include "real.hpp"
#include "signals.hpp"

namespace lockstep {

thread_local uint64_t sleeps = 0;
thread_local bool reads_clock_freely = false;

namespace {

thread_local Sleeper * own_sleeper = nullptr;
constexpr pid_t ALL_THREADS = std::numeric_limits<pid_t>::max();

}  // namespace

Core & core() {
  static Core * const only = new Core;
  return *only;
}

pid_t thread_number() {
  static thread_local pid_t number = 0;
  static thread_local pid_t process = 0;
  // The only thread of a forked child has its parent's memory, and another number.
  if (process != getpid()) { process = getpid(); number = static_cast<pid_t>(syscall(SYS_gettid)); }
  return number;
}

bool Sleeper::satisfied() const {
  if (semaphore && semaphore->load() > 0) return true;
  if (!files) return false;
  std::vector<pollfd> copy(files, files + file_count);
  return real::poll()(copy.data(), copy.size(), 0) > 0;
}

// ---- the lock

void Core::lock() {
  ++entering_;
  pthread_mutex_lock(&mutex_);
  --entering_;
}

void Core::unlock() {
  std::vector<Later> calls;
  calls.swap(later_);
  if (calls.empty()) { pthread_mutex_unlock(&mutex_); return; }
  ++calling_;
  pthread_mutex_unlock(&mutex_);
  for (const Later & call : calls) call.function(call.data, call.count);
  --calling_;
  lock();
  changed_ = true;
  poke();
  pthread_mutex_unlock(&mutex_);
}

void Core::call_later(void (*function)(const void *, size_t), const void * data, size_t count) {
  later_.push_back({function, data, count});
}

// The reporting thread may fall asleep in a call that this library does not see, so the listener has to check.
void Core::report(const uint8_t * frame, size_t size) {
  send(frame, size);
  check_again();
}

void Core::check_again() {
  changed_ = true;
  poke();
}

lockstep_moment Core::here() { return {handled_, now(), static_cast<uint32_t>(thread_number())}; }

// ---- sleeping

void Core::fall_asleep(Sleeper & sleeper) {
  if (may_lengthen(sleeper)) lengthen(sleeper, now());
  ++sleeps;
  sleeper.thread = thread_number();
  sleepers_.push_back(&sleeper);
  own_sleeper = &sleeper;
  changed_ = true;
  if (!connected_) return;
  step();
  while (!later_.empty()) {
    unlock();
    lock();
    step();
  }
  if (recheck_) poke();
}

void Core::wake_up(Sleeper & sleeper) {
  own_sleeper = nullptr;
  sleepers_.erase(std::find(sleepers_.begin(), sleepers_.end(), &sleeper));
  changed_ = true;
}

void Core::wake(Sleeper & sleeper, bool due) {
  if (sleeper.awake.load()) return;
  sleeper.due = due;
  sleeper.awake.store(1);
  nudge(sleeper);
}

// A signal may come just before the thread enters its system call, which then is not interrupted. So the listener wakes
// the thread again.
void Core::interrupt() {
  if (!own_sleeper || !connected_) return;
  const int fault = errno;
  own_sleeper->interrupted = true;
  own_sleeper->awake = 1;
  disturbed_ = true;
  const uint64_t one = 1;
  (void)!write(poke_, &one, sizeof one);
  errno = fault;
}

// Wake a thread whose `awake` is set, in the way in which it sleeps. False: that may have been too early, so repeat it.
bool Core::nudge(const Sleeper & sleeper) {
  if (sleeper.semaphore) {
    const int operation = FUTEX_WAKE | (sleeper.semaphore_shared ? 0 : FUTEX_PRIVATE_FLAG);
    syscall(SYS_futex, sleeper.semaphore, operation, INT32_MAX, nullptr, nullptr, 0);
    return false;
  }
  if (sleeper.condition) { real::pthread_cond_broadcast()(sleeper.condition); return false; }
  if (sleeper.event >= 0) { const uint64_t one = 1; return write(sleeper.event, &one, sizeof one) == sizeof one; }
  syscall(SYS_futex, &sleeper.awake, FUTEX_WAKE | FUTEX_PRIVATE_FLAG, 1, nullptr, nullptr, 0);
  return true;
}

bool Core::may_lengthen(const Sleeper & sleeper) const {
  return sleeper.period && sleeper.period <= LONGEST_SLEEP / 2 && !has_own_pace_ && poll_loop.can_wait();
}

// Let polling threads see what happens now. At the same moment, threads with a higher number than `thread` poll later.
void Core::shorten_sleeps(pid_t thread) {
  for (Sleeper * sleeper : sleepers_)
    if (sleeper->lengthened) shorten(*sleeper, sleeper->thread > thread ? now() - 1 : now());
}

void Core::sent_output() {
  sent_output_ = true;
  has_own_pace_ |= poll_loop.is_fruitless();
}

// ---- idle

// A child may end at any moment, and its end may wake a thread. So this comes first: a child that ends while the threads
// are checked is still reported as alive, and the hub asks again.
void Core::forget_dead_children() {
  children_.erase(std::remove_if(children_.begin(), children_.end(), [](pid_t child) {
    siginfo_t info{};
    const int result = waitid(P_PID, child, &info, WEXITED | WNOWAIT | WNOHANG);
    return result != 0 || info.si_pid == child;
  }), children_.end());
}

Core::Idle Core::idle() {
  forget_dead_children();
  if (entering_ || calling_ || !later_.empty()) return Idle::look_again;
  bool holds_interpreter = false;
  std::vector<pid_t> known{listener_};
  for (const Sleeper * sleeper : sleepers_) {
    if (sleeper->awake) { nudge(*sleeper); return Idle::look_again; }
    if (sleeper->satisfied()) return Idle::look_again;
    if (sleeper->certain()) known.push_back(sleeper->thread);
    holds_interpreter |= sleeper->holds_interpreter;
  }
  const int contending = contenders.count();
  if (contending && !holds_interpreter) return Idle::look_again;
  if (holds_interpreter) contenders.append_to(known);
  flags_ = 0;
  const unsigned count = threads_.count();
  others_ = count > known.size() ? count - static_cast<unsigned>(known.size()) : 0;
  switch (others_ ? threads_.look(known, !children_.empty()) : Threads::Look::asleep) {
    case Threads::Look::busy: return Idle::look_again;
    case Threads::Look::timed: flags_ = 2; return Idle::look_again;
    case Threads::Look::asleep: break;
  }
  // A thread may have posted a semaphore since, and ended before it was listed. Who waits for it may not have run yet.
  const bool waiting = std::none_of(sleepers_.begin(), sleepers_.end(), [](Sleeper * one) { return one->satisfied(); });
  return entering_ || contenders.count() != contending || !waiting ? Idle::look_again : Idle::yes;
}

void Core::step() {
  recheck_ = false;
  if (disturbed_.exchange(false)) changed_ = true;
  while (connected_) {
    uint32_t size = 0;
    const uint8_t * frame = front(size);
    const char kind = frame ? static_cast<char>(frame[0]) : 0;
    const bool gate = kind == 'T' || kind == '|';
    if (kind == 'F') {
      holds_ = false;
      pop();
      continue;
    }
    if (frame && holds_ && !awaited) {
      hold(frame, size);
      continue;
    }
    if (gate && awaited) {  // a thread waits for a frame behind it: see lockstep_block_until
      time_runs_ = false;
      pop();
      continue;
    }
    if (frame && !time_runs_ && !gate) {
      if (kind == '?') asked_ = true;
      else take(frame, size);
      pop();
      continue;
    }
    if (!frame && !time_runs_ && !changed_) return;
    if (idle() != Idle::yes || signals().give_up()) { recheck_ = true; return; }
    if (kind == 'T' && !time_runs_) begin_time(frame, size);
    if (time_runs_) {
      go_on();
    } else if (kind == '|') {
      pop();
    } else {
      announce();
    }
  }
}

void Core::take(const uint8_t * frame, uint32_t size) {
  shorten_sleeps(ALL_THREADS);
  if (participant_) participant_->frame(frame, size);
}

void Core::begin_time(const uint8_t * frame, uint32_t size) {
  Reader reader(frame + 1, size - 1);
  until_ = std::max(reader.get<int64_t>(), now());
  stop_at_output_ = reader.get<uint8_t>() != 0;
  time_runs_ = true;
  sent_output_ = has_forked_ = false;
}

// Called when the process is idle. Wake the thread with the earliest deadline, or finish the TIME frame.
void Core::go_on() {
  if (!(stop_at_output_ && sent_output_) && !has_forked_) {
    Sleeper * next = nullptr;
    for (Sleeper * sleeper : sleepers_) {
      const bool sooner = !next || sleeper->deadline < next->deadline ||
                          (sleeper->deadline == next->deadline && sleeper->thread < next->thread);
      if (sleeper->deadline <= until_ && sooner) next = sleeper;
    }
    const int64_t own = participant_ ? participant_->next() : NEVER;
    if (own <= until_ && (!next || own <= next->deadline)) {
      now_ = std::max(now(), own);
      shorten_sleeps(ALL_THREADS);
      participant_->due(now());
      return;
    }
    if (next) {
      now_ = std::max(now(), next->deadline);
      next->lengthened = false;
      shorten_sleeps(next->thread);
      wake(*next, true);
      return;
    }
    now_ = until_;
  }
  time_runs_ = false;
  pop();
  if (now() < until_ && has_forked_) {
    holds_ = true;
    held_until_ = until_;
  } else if (now() >= held_until_) {
    in_.insert(in_.begin() + static_cast<long>(in_at_), held_.begin(), held_.end());
    held_.clear();
    held_count_ = 0;
  }
}

// After a fork only the hub knows when everything is idle, so time ends early. What the hub has sent until it knows of
// the fork belongs to a later time, and is kept for that.
void Core::hold(const uint8_t * frame, uint32_t size) {
  held_.insert(held_.end(), frame - sizeof size, frame + size);
  in_at_ += sizeof size + size;
  ++held_count_;
  changed_ = true;
}

void Core::announce() {
  int64_t next = participant_ ? participant_->next() : NEVER;
  uint32_t timed = 0;
  for (const Sleeper * sleeper : sleepers_) {
    next = std::min(next, sleeper->deadline);
    timed += sleeper->deadline != NEVER;
  }
  const uint64_t runs = asked_ ? threads_.runs(listener_) : 0;
  std::vector<uint8_t> frame;
  {
    Writer writer(frame, 'I');
    writer.put<uint64_t>(handled_ + held_count_).put<int64_t>(now()).put<int64_t>(next == NEVER ? -1 : next);
    writer.put<uint32_t>(participant_ ? participant_->waiting() : 0).put<uint32_t>(timed).put<uint32_t>(others_);
    writer.put<uint8_t>(flags_).put<uint64_t>(runs);
    const auto count = static_cast<uint16_t>(std::min<size_t>(children_.size(), 1000));
    writer.put<uint16_t>(count);
    for (uint16_t i = 0; i < count; ++i) writer.put<uint32_t>(children_[i]);
  }
  changed_ = asked_ = false;
  send(frame.data(), frame.size());
}

// ---- processes

void Core::forked(pid_t child) {
  if (child <= 0 || !connected_) return;
  children_.push_back(child);
  has_forked_ = true;
  std::vector<uint8_t> frame;
  Writer(frame, 'F').put<uint32_t>(child).put<int64_t>(now());
  report(frame.data(), frame.size());
}

void Core::reset_in_child(bool connect_again) {
  mutex_ = PTHREAD_MUTEX_INITIALIZER;
  entering_ = calling_ = 0;
  contenders.forget();
  awaited = 0;
  sleepers_.clear();
  children_.clear();
  later_.clear();
  threads_.forget();
  signals().forget();
  for (const int file : {socket_, poke_}) if (file >= 0) close(file);
  socket_ = poke_ = -1;
  in_.clear();
  in_at_ = 0;
  held_.clear();
  held_count_ = 0;
  const bool was_connected = connected_;
  connected_ = false;
  handled_ = 0;
  time_runs_ = asked_ = has_own_pace_ = has_forked_ = holds_ = false;
  if (participant_) participant_->reset();
  if (was_connected && connect_again) connect(std::string(path_));
}

}  // namespace lockstep
