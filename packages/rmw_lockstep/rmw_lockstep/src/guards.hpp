// Guard conditions, by which threads wake one another, and rclpy's executor itself.
#pragma once

#include <cstdint>

#include "rmw/types.h"

namespace rmw_lockstep {

struct Guard {
  bool triggered = false;
  uint32_t thread = 0;   // that has triggered it since it was last taken; 0 if there were several
  uint64_t times = 0;    // since then
  void trigger(uint32_t by);

  // Whether it is an executor's that has been triggered only for what `expected` says, and its thread's count then.
  bool only_expected = true;
  bool waited_for = false;
  uint64_t expected = 0;
};

// The calling thread has taken a message, or made an endpoint. An executor triggers its guard condition twice for each
// callback that does not await anything: when it has taken the message, and afterwards (rclpy/executors.py,
// `_make_handler`). It triggers it once for each endpoint (rclpy/node.py, `_wake_executor`).
void expect_callback();
void expect_endpoint();

// To be called whenever a thread begins to wait. Whether the executor in this thread has triggered its guard condition,
// and would find nothing to do if that woke it: it has run callbacks, and whatever it does besides (such as starting a
// task, or going on with a coroutine) has never triggered its guard condition.
bool wakes_only_itself(const rmw_guard_conditions_t & guards);

// Forget that they have been triggered; the other one keeps those that have been, and sets all others to null.
void take_all(rmw_guard_conditions_t & guards);
void keep_triggered(rmw_guard_conditions_t & guards);

}  // namespace rmw_lockstep
