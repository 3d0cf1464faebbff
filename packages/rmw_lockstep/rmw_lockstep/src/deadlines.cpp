// Deadlines and liveliness: events because nothing happened in time. All times are of the steady clock (ns).
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
void count(Endpoint & endpoint, Status & status, rmw_event_type_t type) {
  ++status.total_count;
  ++status.total_count_change;
  endpoint.events.raise(type);
}

void miss_deadline(Endpoint & endpoint) {
  endpoint.next_deadline += nanoseconds(endpoint.qos.deadline);
  auto & events = endpoint.events;
  if (endpoint.kind == Kind::publisher) count(endpoint, events.offered_deadline, RMW_EVENT_OFFERED_DEADLINE_MISSED);
  else count(endpoint, events.requested_deadline, RMW_EVENT_REQUESTED_DEADLINE_MISSED);
}

bool by_hand(const Endpoint & publisher) {
  return publisher.qos.liveliness == RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC;
}

}  // namespace

// Assert that a publisher of this process is alive: it has published, or called `assert_liveliness`.
void Graph::assert_liveliness(Endpoint & publisher) {
  if (!by_hand(publisher)) return;
  publisher.asserted = true;
  publisher.alive_until = after(publisher.qos.liveliness_lease_duration);
  publisher_is_alive(publisher.id);
  if (publisher.announced) frames::send_alive(publisher.id);
}

// The same, received by this process's subscriptions.
void Graph::publisher_is_alive(uint64_t id) {
  Endpoint * publisher = find(id);
  if (!publisher) return;
  publisher->asserted = true;
  for (Endpoint * other : named(publisher->name))
    if (other->local && other->publishers.count(id)) subscription_got(*other, id);
  notify();
}

// Note for a subscription that a publisher is alive, and that its message is in time.
void Graph::subscription_got(Endpoint & subscription, uint64_t id) {
  const Endpoint * publisher = find(id);
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

void Graph::lose_publisher(Endpoint & subscription, Matched & publisher) {
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
  for (const auto & [_, endpoint] : endpoints_) {
    if (!endpoint->local) continue;
    next = std::min({next, endpoint->next_deadline, endpoint->alive_until});
    for (const auto & [publisher, alive] : endpoint->publishers) next = std::min(next, alive.until);
  }
  return next;
}

void Graph::due(int64_t now) {
  if (!timed_) return;
  for (auto & [_, endpoint] : endpoints_) {
    if (!endpoint->local) continue;
    while (endpoint->next_deadline <= now) miss_deadline(*endpoint);
    if (endpoint->alive_until <= now) {
      endpoint->alive_until = FOREVER;
      count(*endpoint, endpoint->events.liveliness_lost, RMW_EVENT_LIVELINESS_LOST);
    }
    for (auto & [publisher, alive] : endpoint->publishers)
      if (alive.until <= now && alive.alive) lose_publisher(*endpoint, alive);
  }
  notify();
}

}  // namespace rmw_lockstep
