#include "polling.hpp"

namespace lockstep {

thread_local Polling polling;

void Polling::look(bool in_vain) {
  const bool goes_on = in_vain && sleeps - slept_ <= 1;
  looks_ = goes_on ? looks_ + (sleeps != slept_) : 0;
  slept_ = sleeps;
}

bool Polling::can_wait() const { return in_vain() && sleeps == slept_; }

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
