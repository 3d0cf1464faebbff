#include "poll_loop.hpp"

namespace lockstep {

thread_local PollLoop poll_loop;

void PollLoop::poll(bool fruitless) {
  const bool goes_on = fruitless && sleeps - slept_ <= 1;
  polls_ = goes_on ? polls_ + (sleeps != slept_) : 0;
  slept_ = sleeps;
}

bool PollLoop::can_wait() const { return is_fruitless() && sleeps == slept_; }

void lengthen(Sleeper & sleeper, int64_t now) {
  sleeper.begin = now;
  sleeper.deadline = now + LONGEST_SLEEP / sleeper.period * sleeper.period;
  sleeper.lengthened = true;
}

void shorten(Sleeper & sleeper, int64_t now) {
  const int64_t turns = (now - sleeper.begin) / sleeper.period + 1;
  sleeper.deadline = sleeper.begin + turns * sleeper.period;
  sleeper.lengthened = false;
}

}  // namespace lockstep
