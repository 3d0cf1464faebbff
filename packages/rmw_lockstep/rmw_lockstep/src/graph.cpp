#include "graph.hpp"

#include <algorithm>

#include "frames.hpp"
#include "qos.hpp"

namespace rmw_lockstep {
namespace {

int64_t time_of(const rmw_time_t & time) { return nanoseconds(time); }

bool has_times(const Endpoint & endpoint) {
  return time_of(endpoint.qos.deadline) != FOREVER || time_of(endpoint.qos.liveliness_lease_duration) != FOREVER;
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

Endpoint & Graph::add(std::unique_ptr<Endpoint> owned) {
  Endpoint & endpoint = *owned;
  endpoints_[endpoint.id] = std::move(owned);
  timed_ += has_times(endpoint);
  if (endpoint.local) announce(endpoint);
  const auto others = named(endpoint.name);
  by_name_[endpoint.name].push_back(&endpoint);
  for (Endpoint * other : others) match(endpoint, *other);
  changed();
  return endpoint;
}

void Graph::announce(Endpoint & endpoint) {
  if (!joined_) return;
  frames::send_endpoint(endpoint);
  endpoint.announced = true;
}

void Graph::remove(uint64_t id) {
  auto found = endpoints_.find(id);
  if (found == endpoints_.end()) return;
  Endpoint & endpoint = *found->second;
  auto & list = by_name_[endpoint.name];
  list.erase(std::find(list.begin(), list.end(), &endpoint));
  for (Endpoint * other : list) unmatch(*other, endpoint);
  if (list.empty()) by_name_.erase(endpoint.name);
  timed_ -= has_times(endpoint);
  if (endpoint.announced) frames::send_gone('e', id);
  endpoints_.erase(found);
  changed();
}

Endpoint * Graph::find(uint64_t id) const {
  auto found = endpoints_.find(id);
  return found == endpoints_.end() ? nullptr : found->second.get();
}

std::vector<Endpoint *> Graph::named(const std::string & name) const {
  auto found = by_name_.find(name);
  return found == by_name_.end() ? std::vector<Endpoint *>() : found->second;
}

void Graph::changed() {
  ++activity;
  for (auto & [_, node] : nodes_)
    if (node->graph_changed) static_cast<Guard *>(node->graph_changed->data)->trigger(lockstep_here().thread);
  notify();
}

// ---- who receives from whom

namespace {

struct Pair { Endpoint & publisher; Endpoint & subscription; };

Pair pair_of(Endpoint & one, Endpoint & other) {
  return one.kind == Kind::publisher ? Pair{one, other} : Pair{other, one};
}

bool connected(const Endpoint & one, const Endpoint & other) {
  if (!same_topic(one, other) || one.type != other.type) return false;
  const bool first = one.kind == Kind::publisher;
  return compatible(first ? one.qos : other.qos, first ? other.qos : one.qos);
}

}  // namespace

void Graph::match(Endpoint & one, Endpoint & other) {
  if (!same_topic(one, other) || (!one.local && !other.local)) return;
  auto [publisher, subscription] = pair_of(one, other);
  if (publisher.type != subscription.type) {
    for (Endpoint * end : {&publisher, &subscription}) {
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

void Graph::unmatch(Endpoint & stays, const Endpoint & goes) {
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

void Graph::matched_changed(Endpoint & endpoint, int by) {
  if (!endpoint.local) return;
  auto & status = endpoint.events.matched;
  if (by > 0) { ++status.total_count; ++status.total_count_change; }
  status.current_count += by;
  status.current_count_change += by;
  endpoint.events.raise(
      endpoint.kind == Kind::publisher ? RMW_EVENT_PUBLICATION_MATCHED : RMW_EVENT_SUBSCRIPTION_MATCHED);
}

void Graph::incompatible(Endpoint & endpoint, rmw_qos_policy_kind_t policy) {
  if (!endpoint.local) return;
  auto & status = endpoint.events.incompatible_qos;
  ++status.total_count;
  ++status.total_count_change;
  status.last_policy_kind = policy;
  endpoint.events.raise(endpoint.kind == Kind::publisher ? RMW_EVENT_OFFERED_QOS_INCOMPATIBLE
                                                           : RMW_EVENT_REQUESTED_QOS_INCOMPATIBLE);
}

// What a transient-local publisher has kept is sent to a transient-local subscription that joins late.
void Graph::replay(Endpoint & publisher, const Endpoint & subscription) {
  if (!is_transient_local(subscription.qos)) return;
  for (const Message & message : publisher.history) {
    if (message.expires <= lockstep_now()) continue;
    if (subscription.local) deliver(publisher, message, subscription.id);
    else if (publisher.announced) frames::send_data(publisher.id, subscription.id, message);
  }
  if (!subscription.local && publisher.announced) frames::send_replayed(publisher.id, subscription.id);
}

void Graph::replayed(uint64_t publisher, uint64_t subscription) {
  Endpoint * endpoint = find(subscription);
  if (!endpoint) return;
  auto found = endpoint->publishers.find(publisher);
  if (found != endpoint->publishers.end()) found->second.replays = false;
}

size_t Graph::matched(const Endpoint & endpoint) const {
  const auto others = named(endpoint.name);
  return std::count_if(others.begin(), others.end(), [&](Endpoint * other) { return connected(endpoint, *other); });
}

bool Graph::heard_elsewhere(const Endpoint & publisher) const {
  const auto others = named(publisher.name);
  return std::any_of(others.begin(), others.end(), [&](Endpoint * other) {
    return !other->local && connected(publisher, *other);
  });
}

bool Graph::server_is_there(const Endpoint & client) const {
  const auto others = named(client.name);
  return std::any_of(others.begin(), others.end(), [&](Endpoint * other) {
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
      if (auto endpoint = static_cast<const Endpoint *>(items[i]); endpoint && !endpoint->queue.empty()) return true;
    return false;
  };
  if (subscriptions && any(subscriptions->subscriber_count, subscriptions->subscribers)) return true;
  if (services && any(services->service_count, services->services)) return true;
  if (clients && any(clients->client_count, clients->clients)) return true;
  for (size_t i = 0; events && i < events->event_count; ++i) {
    auto event = static_cast<const rmw_event_t *>(events->events[i]);
    if (event && static_cast<const Endpoint *>(event->data)->events.pending[event->event_type]) return true;
  }
  return false;
}

void Graph::notify() {
  for (Waiter * waiter : waiters)
    if (waiter->thread.sleeper && waiter->ready(!waiter->rests)) lockstep_wake(&waiter->thread);
}

}  // namespace rmw_lockstep
