// Guard conditions, by which threads wake one another, and by which rclpy's executor wakes itself.
#pragma once

#include <cstdint>

#include "rmw/types.h"

namespace rmw_lockstep {

struct Guard {
  bool triggered = false;
  uint32_t thread = 0;   // the one that has triggered it since it was last taken; 0 if several have
  uint64_t times = 0;    // how often it was triggered since then
  void trigger(uint32_t by);

  // Whether it belongs to an executor that has triggered it only as often as expected so far, and the count so far.
  bool only_expected = true;
  bool waited_for = false;
  uint64_t expected = 0;
};

// Note that the calling thread has taken a message, or made an endpoint. An executor triggers its guard condition twice for each
// callback that does not await anything: when it has taken the message, and afterwards (rclpy/executors.py,
// `_make_handler`). It triggers it once for each endpoint (rclpy/node.py, `_wake_executor`).
void expect_callback();
void expect_endpoint();

// Return whether the executor in this thread has triggered its own guard condition and would find nothing to do if that
// woke it. That holds as long as it only runs callbacks: tasks and coroutines would trigger it more often. Call this
// whenever a thread begins to wait.
bool wakes_only_itself(const rmw_guard_conditions_t & guards);

// Reset all of them; the second function also sets those that were not triggered to null.
void take_all(rmw_guard_conditions_t & guards);
void keep_triggered(rmw_guard_conditions_t & guards);

}  // namespace rmw_lockstep
