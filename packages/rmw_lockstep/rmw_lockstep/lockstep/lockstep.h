// liblockstep: the end of the hub's socket in every process of a program under test. See PROTOCOL.md.
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

/// What the hub's frames other than time and barriers are passed to, with the lock held. `next` returns when the
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

/// Report that the calling thread has sent a message or request, to whomever: it does not just wait for a time to come.
LOCKSTEP_API void lockstep_sent(void);

/// Let the calling thread wait until it is woken or until `deadline` on the steady clock. The lock is released
/// meanwhile. Returns 1 if it was woken. `waiter` must exist until then.
typedef struct lockstep_waiter { void * sleeper; int woken; } lockstep_waiter;
LOCKSTEP_API int lockstep_wait(lockstep_waiter * waiter, int64_t deadline);
LOCKSTEP_API void lockstep_wake(lockstep_waiter * waiter);

/// Block, in real time, until `*done` is not 0 or the hub is gone. The thread counts as busy. Times and barriers that
/// the hub has sent end meanwhile: what the thread waits for may be behind them.
LOCKSTEP_API void lockstep_block_until(const volatile int * done);

/// Wait until rclpy's thread for signals has done what the signals so far ask for: at once, if there were none. Called
/// without the lock.
LOCKSTEP_API void lockstep_settle_signals(void);

/// How often the calling thread has waited for anything so far: two equal answers mean that it never waited in between.
LOCKSTEP_API uint64_t lockstep_sleeps(void);

/// Report that the calling thread has looked for something without waiting. `in_vain`: it found nothing, and nothing has
/// happened since it looked before. While that goes on, its short sleeps become longer: see PROTOCOL.md, "Idle".
LOCKSTEP_API void lockstep_looked(int in_vain);

/// Call `function(data, count)` once the lock is released.
LOCKSTEP_API void lockstep_call_later(void (*function)(const void *, size_t), const void * data, size_t count);

#ifdef __cplusplus
}
#endif

#endif  // LOCKSTEP_H_
