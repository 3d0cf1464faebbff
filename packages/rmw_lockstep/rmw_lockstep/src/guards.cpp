#include "guards.hpp"

#include <utility>

#include "../lockstep/lockstep.h"

namespace rmw_lockstep {
namespace {

constexpr int FOR_CALLBACK = 2, FOR_ENDPOINT = 1;

// An executor triggers it once when its first node is added.
constexpr uint64_t BEFORE_FIRST_WAIT = 1;

// How often the calling thread's executor is expected to have triggered its guard condition so far.
thread_local uint64_t expected = 0;

template<typename Each>
void for_triggered(const rmw_guard_conditions_t & guards, Each each) {
  for (size_t i = 0; i < guards.guard_condition_count; ++i)
    if (auto guard = static_cast<Guard *>(guards.guard_conditions[i]); guard && guard->triggered) each(*guard);
}

// Whether a guard condition has been triggered as often as expected since the last wait. `only`: no other one was.
bool as_expected(Guard & guard, bool only) {
  const uint64_t since = expected - std::exchange(guard.expected, expected);
  const bool first = !std::exchange(guard.waited_for, true);
  const bool same = first ? guard.times <= BEFORE_FIRST_WAIT : guard.times == since;
  guard.only_expected &= only && same && guard.thread == lockstep_here().thread;
  return guard.only_expected && !first;
}

}  // namespace

void Guard::trigger(uint32_t by) {
  thread = triggered && thread != by ? 0 : by;
  times = triggered ? times + 1 : 1;
  triggered = true;
}

void expect_callback() { expected += FOR_CALLBACK; }
void expect_endpoint() { expected += FOR_ENDPOINT; }

bool wakes_only_itself(const rmw_guard_conditions_t & guards) {
  int count = 0;
  bool all = true;
  for_triggered(guards, [&](Guard &) { ++count; });
  for_triggered(guards, [&](Guard & guard) { all &= as_expected(guard, count == 1); });
  return count && all;
}

void take_all(rmw_guard_conditions_t & guards) {
  for_triggered(guards, [](Guard & guard) { guard.triggered = false; });
}

void keep_triggered(rmw_guard_conditions_t & guards) {
  for (size_t i = 0; i < guards.guard_condition_count; ++i) {
    auto guard = static_cast<Guard *>(guards.guard_conditions[i]);
    if (guard && !std::exchange(guard->triggered, false)) guards.guard_conditions[i] = nullptr;
  }
}

}  // namespace rmw_lockstep
