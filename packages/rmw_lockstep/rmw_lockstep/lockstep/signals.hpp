// rclpy's thread for signals.
//
// On SIGINT and SIGTERM, rclpy's handler posts a semaphore. A thread that waits for it wakes every executor, and then
// shuts the contexts down, while the thread that the signal interrupted raises KeyboardInterrupt and goes on. Which of
// them is first would depend on how busy the machine is. Here rclpy's thread is: `settle` waits for it.
#pragma once

#include <semaphore.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>

namespace lockstep {

class Signals {
public:
  // Around a wait without a time-out: the calling thread is about to wait; it has got what it waited for.
  void waits(sem_t * semaphore, const void * caller);
  void got(sem_t * semaphore);
  // Before a semaphore is posted. May be called by a signal handler.
  void posts(sem_t * semaphore);

  // Wait until rclpy's thread has done what the signals so far ask for, or has ended, or `give_up` is called.
  // Not to be called with a lock held that rclpy's thread may need.
  void settle();
  // Let the threads in `settle` go on, if there are any; returns whether there are.
  bool give_up();

  // rclpy's thread has ended; so it has in the child of a fork.
  void forget();

private:
  bool pending() const { return static_cast<int32_t>(arrived_.load() - handled_.load()) > 0; }
  void begin(sem_t * semaphore);
  void handled(uint32_t count);

  std::atomic<sem_t *> semaphore_{nullptr};
  std::atomic<pid_t> thread_{0};
  std::atomic<uint32_t> arrived_{0}, handled_{0};  // signals
  std::atomic<int> settling_{0};                   // threads in `settle`
  uint32_t taken_ = 0;                             // signals that rclpy's thread has begun to handle
};

Signals & signals();

}  // namespace lockstep
