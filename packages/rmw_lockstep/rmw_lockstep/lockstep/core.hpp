// The state of this process: its connection, its time and its sleeping threads.
#pragma once

#include <poll.h>
#include <pthread.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "lockstep.h"
#include "threads.hpp"

namespace lockstep {

constexpr int64_t NEVER = LOCKSTEP_NEVER;

// A thread that waits in this library; lives on that thread's stack. It is in `Core::sleepers_` from before it falls
// asleep until after it has woken, so that a thread on its way into or out of its sleep is never taken to be asleep.
struct Sleeper {
  int64_t deadline = NEVER;          // on the steady clock (ns)
  int64_t period = 0;                // what the program asked for (ns), if it may sleep longer while nothing happens
  int64_t begin = 0;                 // of a sleep that has been lengthened
  bool lengthened = false;
  pid_t thread = 0;
  std::atomic<uint32_t> awake{0};    // what the thread sleeps on; not 0 once it has been told to wake up
  bool due = false;                  // woken because its deadline has passed
  std::atomic<bool> interrupted{false};  // woken by a signal, which may have come just before it slept
  // How it sleeps, if it can be woken by more than this library:
  std::atomic<uint32_t> * semaphore = nullptr;  // the value of a POSIX semaphore
  bool semaphore_shared = false;
  pthread_cond_t * condition = nullptr;
  int event = -1;                    // an eventfd that it polls, together with
  const pollfd * files = nullptr;    // these files
  nfds_t file_count = 0;
  bool holds_interpreter = false;    // it reads the clock repeatedly, and threads that wait for it wait for Python

  // Whether something other than its deadline would wake it now.
  bool satisfied() const;
  // Whether being in the list proves that it sleeps. With a condition variable, nobody knows which waiter was woken.
  bool certain() const { return !condition; }
};

class Core {
public:
  // The lock. To the kernel, a thread that waits for it looks asleep, so these threads are counted.
  void lock();
  void unlock();

  int connect(const std::string & path);
  bool connected() const { return connected_; }
  bool virtual_time() const { return virtual_.load(std::memory_order_relaxed); }
  int64_t now() const { return now_.load(std::memory_order_relaxed); }
  int64_t epoch() const { return epoch_; }
  uint32_t process() const { return process_; }

  // Call everything below with the lock held.
  void participate(const lockstep_participant * participant) { participant_ = participant; }
  // Send the hub a frame about the graph, or a message. From then on the hub considers the process busy.
  void report(const uint8_t * frame, size_t size);
  void sent_output();
  lockstep_moment here();
  void call_later(void (*function)(const void *, size_t), const void * data, size_t count);

  // Put a sleeper into the list, and check whether the process is idle now; remove it again.
  void fall_asleep(Sleeper & sleeper);
  void wake_up(Sleeper & sleeper);
  void wake(Sleeper & sleeper, bool due);

  // Wake the calling thread's own sleeper, if there is one: for signal handlers.
  void interrupt();

  void poke();                     // wake the listener, which then checks again
  void check_again();              // the same, even if nothing has changed since the last IDLE

  // Python's threads that wait for the GIL: about to run, unless the holder of the GIL sleeps.
  Contenders contenders;

  // How many threads wait for a frame in transit, which may be behind a time or a barrier. With the lock held.
  int awaited = 0;

  // After a fork, in the parent and in the child. A child that is about to run exec does not connect.
  void forked(pid_t child);
  void reset_in_child(bool connect_again);

private:
  struct Later { void (*function)(const void *, size_t); const void * data; size_t count; };
  enum class Idle { yes, no, look_again };

  bool may_lengthen(const Sleeper & sleeper) const;
  void shorten_sleeps(pid_t thread);
  void send(const uint8_t * frame, size_t size);
  void listen_to_hub();            // the listener: the library's own thread
  static void * listener_thread(void * core);
  void receive();
  void lost();
  void step();                     // handle what may be handled now
  const uint8_t * front(uint32_t & size) const;
  void pop();
  void take(const uint8_t * frame, uint32_t size);
  void begin_time(const uint8_t * frame, uint32_t size);
  void go_on();                    // one step of time
  void hold(const uint8_t * frame, uint32_t size);
  Idle idle();
  void forget_dead_children();
  bool nudge(const Sleeper & sleeper);
  void announce();

  pthread_mutex_t mutex_ = PTHREAD_MUTEX_INITIALIZER;
  std::atomic<int> entering_{0}, calling_{0};
  std::atomic<bool> virtual_{false};
  std::atomic<int64_t> now_{0};
  bool connected_ = false;
  int socket_ = -1, poke_ = -1;
  std::string path_;
  uint32_t process_ = 0;
  int64_t epoch_ = 0;
  pid_t listener_ = 0;
  bool listener_sleeps_ = false, recheck_ = false;
  const lockstep_participant * participant_ = nullptr;
  std::vector<Sleeper *> sleepers_;
  std::vector<pid_t> children_;
  std::vector<Later> later_;
  Threads threads_;
  uint8_t flags_ = 0;
  unsigned others_ = 0;

  std::vector<uint8_t> in_;
  size_t in_at_ = 0;
  uint64_t handled_ = 0;
  bool changed_ = false;           // since the process reported to be idle
  std::atomic<bool> disturbed_{false};  // by a signal
  bool has_own_pace_ = false;      // it has sent something between fruitless polls, at a time of its own
  bool asked_ = false;             // the hub wants another IDLE, even if nothing has changed
  bool time_runs_ = false, stop_at_output_ = false, sent_output_ = false, has_forked_ = false;
  int64_t until_ = 0;
  bool holds_ = false;             // the hub does not know yet that time has ended early, at a fork
  std::vector<uint8_t> held_;      // what it has sent until then, for the time `held_until_`
  uint64_t held_count_ = 0;
  int64_t held_until_ = 0;
};

// This process's core. It is never destroyed: threads use it until the process ends.
Core & core();

// The kernel's number of the calling thread, and how often it has slept in this library.
pid_t thread_number();
extern thread_local uint64_t sleeps;

// Whether the calling thread's readings of the clock are not counted, as it is not one of the program's threads.
extern thread_local bool reads_clock_freely;

}  // namespace lockstep
