// Threads that poll repeatedly and sleep a little in between, such as an asyncio loop that calls
// `spin_once(timeout_sec=0)` every millisecond.
//
// While nothing happens, one long sleep replaces several short ones. As soon as anything happens in this process, the
// long sleep is shortened to end when the next of the short ones would have ended. So the thread sees everything at the
// same time as if it slept for as long as it asked, but needs fewer turns.
#pragma once

#include <cstdint>

#include "core.hpp"

namespace lockstep {

// After this many fruitless polls in a row, sleeps are lengthened, at most to LONGEST_SLEEP (ns).
constexpr unsigned FRUITLESS_POLLS = 5;
constexpr int64_t LONGEST_SLEEP = 10'000'000;

// How often one thread has polled since anything last happened.
class PollLoop {
public:
  // Count a poll without waiting. `fruitless`: nothing has happened since the one before.
  void poll(bool fruitless);

  // Start again: the thread has read a clock through ROS 2, as for each of its timers, so it acts by its own clock.
  void forget() { polls_ = 0; }

  // Whether the thread does nothing but poll and sleep, and this is its first sleep since the last poll.
  bool can_wait() const;

  // Whether it has polled in vain so often that its sleeps are lengthened.
  bool is_fruitless() const { return polls_ >= FRUITLESS_POLLS; }

private:
  unsigned polls_ = 0;    // fruitless ones in a row, with at most one sleep between two
  uint64_t slept_ = 0;    // how often the thread had slept by the last poll
};
extern thread_local PollLoop poll_loop;

// Lengthen a sleep to a multiple of its period; shorten it again to end at the first multiple after `now`.
void lengthen(Sleeper & sleeper, int64_t now);
void shorten(Sleeper & sleeper, int64_t now);

}  // namespace lockstep
