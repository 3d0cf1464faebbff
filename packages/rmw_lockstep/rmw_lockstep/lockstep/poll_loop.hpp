// Threads that look for something again and again, and sleep a little in between: an asyncio loop that calls
// `spin_once(timeout_sec=0)` every millisecond, for example.
//
// While nothing happens, one long sleep takes the place of several short ones. As soon as anything does happen in this
// process, it is made to end when the next of the short ones would have ended. So the thread sees everything at the same
// time as if it slept for as long as it asked, but it takes fewer turns.
#pragma once

#include <cstdint>

#include "core.hpp"

namespace lockstep {

// After this many looks in vain in a row, sleeps are lengthened, to this much at most (ns).
constexpr unsigned FRUITLESS_POLLS = 5;
constexpr int64_t LONGEST_SLEEP = 10'000'000;

// What one thread has seen since anything last happened.
class PollLoop {
public:
  // The thread has looked for something without waiting. `in_vain`: nothing has happened since it looked before.
  void look(bool in_vain);

  // The thread has read a clock through ROS 2, as it does for each of its timers: it acts by its own clock.
  void forget() { polls_ = 0; }

  // Whether the thread does nothing but look and sleep, and sleeps now for the first time since its last look.
  bool can_wait() const;

  // Whether it has looked in vain so often that its sleeps are lengthened.
  bool is_fruitless() const { return polls_ >= FRUITLESS_POLLS; }

private:
  unsigned polls_ = 0;    // in vain, in a row, with one sleep at most between two
  uint64_t slept_ = 0;    // how often the thread had slept at the last one
};
extern thread_local PollLoop poll_loop;

// Lengthen a sleep to a multiple of its time, and shorten it again to end at the first multiple after `now`.
void lengthen(Sleeper & sleeper, int64_t now);
void shorten(Sleeper & sleeper, int64_t now);

}  // namespace lockstep
