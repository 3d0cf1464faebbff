// Waiting.
#include <algorithm>

#include "checks.hpp"
#include "graph.hpp"
#include "rmw/rmw.h"
#include "rmw/time.h"

using namespace rmw_lockstep;

namespace {

// A thread that polls repeatedly without waiting counts as waiting for this long each time (ns).
constexpr int64_t POLL = 10'000'000;
constexpr int UNCHANGED_POLLS = 2;

// How often this thread has polled in a row while nothing happened.
struct Polls {
  uint64_t activity = 0, sleeps = 0;
  int unchanged = 0;
  void count(bool ready) {
    const uint64_t now = graph().activity, slept = lockstep_sleeps();
    const bool fruitless = !ready && activity == now;
    lockstep_polled(fruitless);
    unchanged = fruitless && sleeps == slept ? unchanged + 1 : 0;
    activity = now;
    sleeps = slept;
  }
};
thread_local Polls polls;

// An executor that always has something to do at one moment never gets past it: with a timer without a period, or a task
// or guard condition that starts itself again, in one thread or in turns with others. After this many turns it counts as
// polling. Everything that is sent, taken or received adds some more turns.
constexpr uint64_t FREE_TURNS = 1'000, TURNS_PER_ACTIVITY = 10;

struct Turns {
  uint64_t count = 0, activity = 0;
  int64_t at = 0;        // the moment (steady time, ns)
  bool too_many() {
    if (at != lockstep_now()) *this = {0, activity, lockstep_now()};
    const uint64_t now = graph().activity, earned = (now - activity) * TURNS_PER_ACTIVITY;
    count = count > earned ? count - earned + 1 : 1;
    activity = now;
    return count > FREE_TURNS;
  }
};
thread_local Turns turns;

int64_t deadline_of(const rmw_time_t * timeout) {
  if (!timeout) return LOCKSTEP_NEVER;
  const auto duration = static_cast<int64_t>(rmw_time_total_nsec(*timeout));
  return duration > INT64_MAX / 2 ? LOCKSTEP_NEVER : lockstep_now() + duration;
}

// Let a thread that polls wait. Returns whether it did.
bool wait_as_poll(Waiter & waiter) {
  // rclpy's spin_once(timeout_sec=0) triggers a guard condition of its own each time, which does not count as activity.
  if (!lockstep_virtual()) return false;
  const bool ready = waiter.ready(false);
  polls.count(ready);
  if (ready || polls.unchanged < UNCHANGED_POLLS) return false;
  lockstep_wait(&waiter.thread, lockstep_now() + POLL);
  polls.sleeps = lockstep_sleeps();
  return true;
}

void wait_until(Waiter & waiter, int64_t deadline) {
  while (!waiter.ready() && lockstep_now() < deadline) {
    if (lockstep_virtual()) {
      lockstep_wait(&waiter.thread, deadline);
    } else {  // nothing else reports when a deadline of the endpoints has passed
      lockstep_wait(&waiter.thread, std::min(deadline, graph().next_due()));
      graph().due(lockstep_now());
    }
  }
}

// Wait as long as a poll takes, but only until `deadline` or until there is something to take.
void rest(Waiter & waiter, int64_t deadline) {
  const int64_t now = lockstep_now();
  waiter.rests = true;
  lockstep_wait(&waiter.thread, deadline > now ? std::min(deadline, now + POLL) : now + POLL);
  waiter.rests = false;
  turns.at = lockstep_now();  // this wait does not count as getting past the moment
}

void keep_ready(size_t count, void ** items) {
  for (size_t i = 0; i < count; ++i)
    if (auto endpoint = static_cast<Endpoint *>(items[i]); endpoint && endpoint->queue.empty()) items[i] = nullptr;
}

// Keep what is ready and set everything else to null, as rmw_wait has to.
void keep_what_is_ready(Waiter & waiter) {
  if (waiter.guards) keep_triggered(*waiter.guards);
  if (waiter.subscriptions) keep_ready(waiter.subscriptions->subscriber_count, waiter.subscriptions->subscribers);
  if (waiter.services) keep_ready(waiter.services->service_count, waiter.services->services);
  if (waiter.clients) keep_ready(waiter.clients->client_count, waiter.clients->clients);
  if (auto events = waiter.events)
    for (size_t i = 0; i < events->event_count; ++i)
      if (auto event = static_cast<rmw_event_t *>(events->events[i]))
        if (!static_cast<Endpoint *>(event->data)->events.pending[event->event_type]) events->events[i] = nullptr;
}

// Whether anything is ready.
bool wait_for(Waiter & waiter, const rmw_time_t * timeout) {
  Lock lock;
  auto & waiters = graph().waiters;
  waiters.push_back(&waiter);
  const int64_t deadline = deadline_of(timeout);
  if (lockstep_virtual() && waiter.guards && wakes_only_itself(*waiter.guards) && !waiter.ready(false)) take_all(*waiter.guards);
  if (lockstep_virtual() && !waiter.ready(false) && turns.too_many()) rest(waiter, deadline);
  else if (deadline > lockstep_now()) wait_until(waiter, deadline);
  else wait_as_poll(waiter);
  waiters.erase(std::find(waiters.begin(), waiters.end(), &waiter));
  const bool ready = waiter.ready();
  keep_what_is_ready(waiter);
  return ready;
}

}  // namespace

RMW_LOCKSTEP_API rmw_wait_set_t * rmw_create_wait_set(rmw_context_t * context, size_t) {
  REQUIRE_OR_NULL(context);
  if (!is_ours(context->implementation_identifier)) return nullptr;
  rmw_wait_set_t * handle = rmw_wait_set_allocate();
  handle->implementation_identifier = IDENTIFIER;
  handle->guard_conditions = nullptr;
  handle->data = nullptr;
  return handle;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_wait_set(rmw_wait_set_t * handle) {
  REQUIRE_OURS(handle);
  rmw_wait_set_free(handle);
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_wait(
    rmw_subscriptions_t * subscriptions, rmw_guard_conditions_t * guards, rmw_services_t * services,
    rmw_clients_t * clients, rmw_events_t * events, rmw_wait_set_t * handle, const rmw_time_t * timeout) {
  REQUIRE_OURS(handle);
  Waiter waiter{subscriptions, guards, services, clients, events, {}};
  const bool ready = wait_for(waiter, timeout);
  lockstep_settle_signals();  // rclpy's thread may still read its list of guard conditions
  return ready ? RMW_RET_OK : RMW_RET_TIMEOUT;
}
