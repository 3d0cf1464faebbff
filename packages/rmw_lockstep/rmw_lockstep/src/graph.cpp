#include "graph.hpp"

#include <algorithm>

#include "frames.hpp"
#include "qos.hpp"

namespace rmw_lockstep {
namespace {

int64_t time_of(const rmw_time_t & time) { return nanoseconds(time); }

bool has_times(const EndPoint & end_point) {
  return time_of(end_point.qos.deadline) != FOREVER || time_of(end_point.qos.liveliness_lease_duration) != FOREVER;
}

}  // namespace

Graph & graph() {
  static Graph * const only = new Graph;
  return *only;
}

uint64_t Graph::new_id() {
  const uint64_t process = lockstep_connected() ? lockstep_process() : 1;
  return process << 32 | ++last_id_;
}

// ---- what there is

void Graph::add(std::unique_ptr<Node> node) {
  if (node->local && joined_) frames::send_node(*node);
  nodes_[node->id] = std::move(node);
  changed();
}

void Graph::remove_node(uint64_t id) {
  auto found = nodes_.find(id);
  if (found == nodes_.end()) return;
  if (found->second->local && joined_) frames::send_gone('n', id);
  nodes_.erase(found);
  changed();
}

EndPoint & Graph::add(std::unique_ptr<EndPoint> owned) {
  EndPoint & end_point = *owned;
  end_points_[end_point.id] = std::move(owned);
  timed_ += has_times(end_point);
  if (end_point.local) announce(end_point);
  const auto others = named(end_point.name);
  by_name_[end_point.name].push_back(&end_point);
  for (EndPoint * other : others) match(end_point, *other);
  changed();
  return end_point;
}

void Graph::announce(EndPoint & end_point) {
  if (!joined_) return;
  frames::send_end_point(end_point);
  end_point.announced = true;
}

void Graph::remove(uint64_t id) {
  auto found = end_points_.find(id);
  if (found == end_points_.end()) return;
  EndPoint & end_point = *found->second;
  auto & list = by_name_[end_point.name];
  list.erase(std::find(list.begin(), list.end(), &end_point));
  for (EndPoint * other : list) unmatch(*other, end_point);
  if (list.empty()) by_name_.erase(end_point.name);
  timed_ -= has_times(end_point);
  if (end_point.announced) frames::send_gone('e', id);
  end_points_.erase(found);
  changed();
}

EndPoint * Graph::find(uint64_t id) const {
  auto found = end_points_.find(id);
  return found == end_points_.end() ? nullptr : found->second.get();
}

std::vector<EndPoint *> Graph::named(const std::string & name) const {
  auto found = by_name_.find(name);
  return found == by_name_.end() ? std::vector<EndPoint *>() : found->second;
}

void Graph::changed() {
  ++activity;
  for (auto & [_, node] : nodes_)
    if (node->graph_changed) static_cast<Guard *>(node->graph_changed->data)->trigger(lockstep_here().thread);
  notify();
}

// ---- who receives from whom

namespace {

struct Pair { EndPoint & publisher; EndPoint & subscription; };

Pair pair_of(EndPoint & one, EndPoint & other) {
  return one.kind == Kind::publisher ? Pair{one, other} : Pair{other, one};
}

bool connected(const EndPoint & one, const EndPoint & other) {
  if (!same_topic(one, other) || one.type != other.type) return false;
  const bool first = one.kind == Kind::publisher;
  return compatible(first ? one.qos : other.qos, first ? other.qos : one.qos);
}

}  // namespace

void Graph::match(EndPoint & one, EndPoint & other) {
  if (!same_topic(one, other) || (!one.local && !other.local)) return;
  auto [publisher, subscription] = pair_of(one, other);
  if (publisher.type != subscription.type) {
    for (EndPoint * end : {&publisher, &subscription}) {
      if (!end->local) continue;
      auto & status = end->events.incompatible_type;
      ++status.total_count;
      ++status.total_count_change;
      end->events.raise(end == &publisher ? RMW_EVENT_PUBLISHER_INCOMPATIBLE_TYPE
                                          : RMW_EVENT_SUBSCRIPTION_INCOMPATIBLE_TYPE);
    }
    return;
  }
  const auto found = mismatches(publisher.qos, subscription.qos);
  if (!found.empty()) {
    incompatible(publisher, found.front());
    incompatible(subscription, found.front());
    return;
  }
  matched_changed(publisher, 1);
  matched_changed(subscription, 1);
  if (subscription.local) {
    Matched & matched = subscription.publishers[publisher.id] = {};
    matched.replays = subscription.announced && !publisher.local && is_transient_local(subscription.qos);
    if (publisher.qos.liveliness != RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC || publisher.asserted)
      subscription_got(subscription, publisher.id);
  }
  if (publisher.local) replay(publisher, subscription);
}

void Graph::unmatch(EndPoint & stays, const EndPoint & goes) {
  if (!stays.local || !connected(stays, goes)) return;
  matched_changed(stays, -1);
  if (stays.kind != Kind::subscription) return;
  auto found = stays.publishers.find(goes.id);
  if (found == stays.publishers.end()) return;
  auto & status = stays.events.liveliness_changed;
  if (found->second.alive) { --status.alive_count; --status.alive_count_change; }
  else if (found->second.asserted) { --status.not_alive_count; --status.not_alive_count_change; }
  if (found->second.asserted) stays.events.raise(RMW_EVENT_LIVELINESS_CHANGED);
  stays.publishers.erase(found);
}

void Graph::matched_changed(EndPoint & end_point, int by) {
  if (!end_point.local) return;
  auto & status = end_point.events.matched;
  if (by > 0) { ++status.total_count; ++status.total_count_change; }
  status.current_count += by;
  status.current_count_change += by;
  end_point.events.raise(
      end_point.kind == Kind::publisher ? RMW_EVENT_PUBLICATION_MATCHED : RMW_EVENT_SUBSCRIPTION_MATCHED);
}

void Graph::incompatible(EndPoint & end_point, rmw_qos_policy_kind_t policy) {
  if (!end_point.local) return;
  auto & status = end_point.events.incompatible_qos;
  ++status.total_count;
  ++status.total_count_change;
  status.last_policy_kind = policy;
  end_point.events.raise(end_point.kind == Kind::publisher ? RMW_EVENT_OFFERED_QOS_INCOMPATIBLE
                                                           : RMW_EVENT_REQUESTED_QOS_INCOMPATIBLE);
}

// What a transient-local publisher has kept is sent to a transient-local subscription that joins late.
void Graph::replay(EndPoint & publisher, const EndPoint & subscription) {
  if (!is_transient_local(subscription.qos)) return;
  for (const Message & message : publisher.history) {
    if (message.expires <= lockstep_now()) continue;
    if (subscription.local) deliver(publisher, message, subscription.id);
    else if (publisher.announced) frames::send_data(publisher.id, subscription.id, message);
  }
  if (!subscription.local && publisher.announced) frames::send_replayed(publisher.id, subscription.id);
}

void Graph::replayed(uint64_t publisher, uint64_t subscription) {
  EndPoint * end_point = find(subscription);
  if (!end_point) return;
  auto found = end_point->publishers.find(publisher);
  if (found != end_point->publishers.end()) found->second.replays = false;
}

size_t Graph::matched(const EndPoint & end_point) const {
  const auto others = named(end_point.name);
  return std::count_if(others.begin(), others.end(), [&](EndPoint * other) { return connected(end_point, *other); });
}

bool Graph::heard_elsewhere(const EndPoint & publisher) const {
  const auto others = named(publisher.name);
  return std::any_of(others.begin(), others.end(), [&](EndPoint * other) {
    return !other->local && connected(publisher, *other);
  });
}

bool Graph::server_is_there(const EndPoint & client) const {
  const auto others = named(client.name);
  return std::any_of(others.begin(), others.end(), [&](EndPoint * other) {
    return other->kind == Kind::server && other->type == client.type;
  });
}

// ---- waiting

bool Waiter::ready(bool guards_count) const {
  if (guards && guards_count)
    for (size_t i = 0; i < guards->guard_condition_count; ++i)
      if (auto guard = static_cast<const Guard *>(guards->guard_conditions[i]); guard && guard->triggered) return true;
  auto any = [](size_t count, void * const * items) {
    for (size_t i = 0; i < count; ++i)
      if (auto end_point = static_cast<const EndPoint *>(items[i]); end_point && !end_point->queue.empty()) return true;
    return false;
  };
  if (subscriptions && any(subscriptions->subscriber_count, subscriptions->subscribers)) return true;
  if (services && any(services->service_count, services->services)) return true;
  if (clients && any(clients->client_count, clients->clients)) return true;
  for (size_t i = 0; events && i < events->event_count; ++i) {
    auto event = static_cast<const rmw_event_t *>(events->events[i]);
    if (event && static_cast<const EndPoint *>(event->data)->events.pending[event->event_type]) return true;
  }
  return false;
}

void Graph::notify() {
  for (Waiter * waiter : waiters)
    if (waiter->thread.sleeper && waiter->ready(!waiter->rests)) lockstep_wake(&waiter->thread);
}

}  // namespace rmw_lockstep
