// liblockstep: a process's end of the connection to the hub. See PROTOCOL.md.
//
// The library is preloaded. It connects to the hub, sets the computer's time as the hub says, lets sleeping threads
// sleep in that time, and reports to the hub when the process is idle. A client that speaks ROS 2 over the connection
// (the RMW next to this folder) registers here.
#ifndef LOCKSTEP_H_
#define LOCKSTEP_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LOCKSTEP_API __attribute__((visibility("default")))
#define LOCKSTEP_NEVER INT64_MAX

/// Connect this process to the hub that listens at `path`; from now on the hub sets its time.
/// Returns 0, or an errno; EALREADY if the process is connected.
LOCKSTEP_API int lockstep_connect(const char * path);

/// Whether the process is connected to a hub.
LOCKSTEP_API int lockstep_connected(void);

/// Whether clock and sleeps of this process are the hub's: connected, and preloaded.
LOCKSTEP_API int lockstep_virtual(void);

/// What the computer's steady clock shows, and what its calendar shows since 1970 (ns).
LOCKSTEP_API int64_t lockstep_now(void);
LOCKSTEP_API int64_t lockstep_calendar(void);

/// The number by which the hub knows this process; 0 without a hub.
LOCKSTEP_API uint32_t lockstep_process(void);

/// The only lock of this process. Everything below is called with the lock held, unless said otherwise. Not recursive.
LOCKSTEP_API void lockstep_lock(void);
LOCKSTEP_API void lockstep_unlock(void);

/// Receives all of the hub's frames except TIME, BARRIER and ASK, with the lock held. `next` returns when the
/// participant wants `due` to be called (ns, LOCKSTEP_NEVER: not at all). `waiting` counts threads in rmw_wait.
/// `reset` is called in the child of a fork, where the connection and what belongs to it are gone.
typedef struct lockstep_participant {
  void (*frame)(const uint8_t * frame, size_t size);
  int64_t (*next)(void);
  void (*due)(int64_t now);
  uint32_t (*waiting)(void);
  void (*reset)(void);
} lockstep_participant;
LOCKSTEP_API void lockstep_participate(const lockstep_participant * participant);

/// Send a whole frame, its length first. Does nothing without a hub.
LOCKSTEP_API void lockstep_send(const uint8_t * frame, size_t size);

/// Where the process is: frames handled, its time, and the calling thread's number. `lockstep_sent_output` reports that
/// a DATA, REQUEST or RESPONSE was sent.
typedef struct lockstep_moment { uint64_t handled; int64_t now; uint32_t thread; } lockstep_moment;
LOCKSTEP_API lockstep_moment lockstep_here(void);
LOCKSTEP_API void lockstep_sent_output(void);

/// Report that the calling thread has sent a message or request, whoever receives it: the thread does more than wait for a time.
LOCKSTEP_API void lockstep_sent(void);

/// Let the calling thread wait until it is woken or until `deadline` on the steady clock. The lock is released
/// meanwhile. Returns 1 if it was woken. `waiter` must exist until then.
typedef struct lockstep_waiter { void * sleeper; int woken; } lockstep_waiter;
LOCKSTEP_API int lockstep_wait(lockstep_waiter * waiter, int64_t deadline);
LOCKSTEP_API void lockstep_wake(lockstep_waiter * waiter);

/// Block, in real time, until `*done` is not 0 or the hub is gone. The thread counts as busy. Frames TIME
/// and BARRIER end early meanwhile: what the thread waits for may be behind them.
LOCKSTEP_API void lockstep_block_until(const volatile int * done);

/// Wait until rclpy's signal thread has handled all signals so far; return at once if there were none. Call it without
/// the lock.
LOCKSTEP_API void lockstep_settle_signals(void);

/// How often the calling thread has waited for anything so far. Two equal results mean that it did not wait in between.
LOCKSTEP_API uint64_t lockstep_sleeps(void);

/// Report that the calling thread has polled without waiting. `fruitless`: it found nothing, and nothing has happened
/// since its last poll. As long as that continues, its short sleeps become longer: see PROTOCOL.md, "Idle".
LOCKSTEP_API void lockstep_polled(int fruitless);

/// Call `function(data, count)` once the lock is released.
LOCKSTEP_API void lockstep_call_later(void (*function)(const void *, size_t), const void * data, size_t count);

#ifdef __cplusplus
}
#endif

#endif  // LOCKSTEP_H_
