// Deadlines and liveliness: what happens because nothing happens. The time is the computer's steady clock's.
#include <algorithm>

#include "frames.hpp"
#include "graph.hpp"
#include "qos.hpp"

namespace rmw_lockstep {
namespace {

int64_t after(const rmw_time_t & time) {
  const int64_t duration = nanoseconds(time);
  return duration == FOREVER ? FOREVER : lockstep_now() + duration;
}

template<typename Status>
void count(EndPoint & end_point, Status & status, rmw_event_type_t type) {
  ++status.total_count;
  ++status.total_count_change;
  end_point.events.raise(type);
}

void miss_deadline(EndPoint & end_point) {
  end_point.next_deadline += nanoseconds(end_point.qos.deadline);
  auto & events = end_point.events;
  if (end_point.kind == Kind::publisher) count(end_point, events.offered_deadline, RMW_EVENT_OFFERED_DEADLINE_MISSED);
  else count(end_point, events.requested_deadline, RMW_EVENT_REQUESTED_DEADLINE_MISSED);
}

bool by_hand(const EndPoint & publisher) {
  return publisher.qos.liveliness == RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC;
}

}  // namespace

// A publisher asserts that it is alive, by publishing or by `assert_liveliness`.
void Graph::assert_liveliness(EndPoint & publisher) {
  if (!by_hand(publisher)) return;
  publisher.asserted = true;
  publisher.alive_until = after(publisher.qos.liveliness_lease_duration);
  publisher_is_alive(publisher.id);
  if (publisher.announced) frames::send_alive(publisher.id);
}

// The same, received by this process's subscriptions.
void Graph::publisher_is_alive(uint64_t id) {
  EndPoint * publisher = find(id);
  if (!publisher) return;
  publisher->asserted = true;
  for (EndPoint * other : named(publisher->name))
    if (other->local && other->publishers.count(id)) subscription_got(*other, id);
  notify();
}

// A subscription gets news of a publisher: it is alive, and its message is in time.
void Graph::subscription_got(EndPoint & subscription, uint64_t id) {
  const EndPoint * publisher = find(id);
  auto known = subscription.publishers.find(id);
  if (!publisher || known == subscription.publishers.end()) return;
  Matched & alive = known->second;
  if (by_hand(*publisher)) alive.until = after(publisher->qos.liveliness_lease_duration);
  if (nanoseconds(subscription.qos.deadline) != FOREVER && (publisher->asserted || !by_hand(*publisher)))
    subscription.next_deadline = after(subscription.qos.deadline);
  if (alive.alive) return;
  auto & status = subscription.events.liveliness_changed;
  if (alive.asserted) { --status.not_alive_count; --status.not_alive_count_change; }
  ++status.alive_count;
  ++status.alive_count_change;
  alive.asserted = alive.alive = true;
  subscription.events.raise(RMW_EVENT_LIVELINESS_CHANGED);
}

void Graph::lose_publisher(EndPoint & subscription, Matched & publisher) {
  publisher.alive = false;
  publisher.until = FOREVER;
  auto & status = subscription.events.liveliness_changed;
  --status.alive_count;
  --status.alive_count_change;
  ++status.not_alive_count;
  ++status.not_alive_count_change;
  subscription.events.raise(RMW_EVENT_LIVELINESS_CHANGED);
}

int64_t Graph::next_due() const {
  int64_t next = FOREVER;
  if (!timed_) return next;
  for (const auto & [_, end_point] : end_points_) {
    if (!end_point->local) continue;
    next = std::min({next, end_point->next_deadline, end_point->alive_until});
    for (const auto & [publisher, alive] : end_point->publishers) next = std::min(next, alive.until);
  }
  return next;
}

void Graph::due(int64_t now) {
  if (!timed_) return;
  for (auto & [_, end_point] : end_points_) {
    if (!end_point->local) continue;
    while (end_point->next_deadline <= now) miss_deadline(*end_point);
    if (end_point->alive_until <= now) {
      end_point->alive_until = FOREVER;
      count(*end_point, end_point->events.liveliness_lost, RMW_EVENT_LIVELINESS_LOST);
    }
    for (auto & [publisher, alive] : end_point->publishers)
      if (alive.until <= now && alive.alive) lose_publisher(*end_point, alive);
  }
  notify();
}

}  // namespace rmw_lockstep
