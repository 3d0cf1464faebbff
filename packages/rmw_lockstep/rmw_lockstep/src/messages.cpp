// Delivers messages, requests and responses from one endpoint to another.
#include <algorithm>

#include "frames.hpp"
#include "graph.hpp"
#include "qos.hpp"

namespace rmw_lockstep {
namespace {

bool bounded(const Endpoint & endpoint) { return endpoint.qos.history != RMW_QOS_POLICY_HISTORY_KEEP_ALL; }

void keep_last(std::deque<Message> & messages, const Endpoint & endpoint) {
  while (bounded(endpoint) && messages.size() > endpoint.qos.depth) messages.pop_front();
}

int64_t expiry(const Endpoint & publisher) {
  const int64_t lifespan = nanoseconds(publisher.qos.lifespan);
  return lifespan == FOREVER ? FOREVER : lockstep_now() + lifespan;
}

bool accepts(const Endpoint & subscription, const Endpoint & publisher, uint64_t only) {
  return subscription.local && subscription.kind == Kind::subscription && (!only || subscription.id == only) &&
         subscription.type == publisher.type && !(subscription.ignores_local && publisher.local) &&
         compatible(publisher.qos, subscription.qos);
}

// Report to the hub after this many messages from one endpoint at one moment that stay inside this process.
constexpr uint32_t REPORTED = 100;

// Log messages do not count: logging in a loop is harmless.
constexpr char LOG[] = "/rosout";

// Whether a message will arrive with the replay that is on its way: now it would be a duplicate, and out of order.
bool comes_later(const Endpoint & subscription, const Endpoint & publisher, uint64_t only) {
  const auto found = subscription.publishers.find(publisher.id);
  return !only && found != subscription.publishers.end() && found->second.replays;
}

}  // namespace

void Graph::publish(Endpoint & publisher, Bytes bytes) {
  ++activity;
  Message message{std::move(bytes), publisher.id, ++publisher.last_number, lockstep_calendar(), 0, expiry(publisher)};
  if (is_transient_local(publisher.qos)) {
    publisher.history.push_back(message);
    keep_last(publisher.history, publisher);
  }
  if (nanoseconds(publisher.qos.deadline) != FOREVER)
    publisher.next_deadline = lockstep_now() + nanoseconds(publisher.qos.deadline);
  if (publisher.qos.liveliness == RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC) assert_liveliness(publisher);
  deliver(publisher, message);
  const bool elsewhere = publisher.announced && heard_elsewhere(publisher);
  if (elsewhere) frames::send_data(publisher.id, 0, message);
  sent(publisher, elsewhere);
  notify();
}

// Without this, the hub would not know why a node that answers its own messages is never idle.
void Graph::sent(Endpoint & sender, bool elsewhere) {
  if (sender.name == LOG) return;
  lockstep_sent();
  if (elsewhere || !sender.announced) return;
  if (sender.kept_at != lockstep_now()) sender.kept_here = 0;
  sender.kept_at = lockstep_now();
  if (++sender.kept_here < REPORTED) return;
  frames::send_kept(sender.id, sender.kept_here);
  sender.kept_here = 0;
}

void Graph::deliver(const Endpoint & publisher, const Message & message, uint64_t only) {
  for (Endpoint * other : named(publisher.name)) {
    if (!accepts(*other, publisher, only) || comes_later(*other, publisher, only)) continue;
    subscription_got(*other, publisher.id);
    Message copy = message;
    copy.expires = expiry(publisher);
    enqueue(*other, std::move(copy));
  }
}

void Graph::request(Endpoint & client, Bytes bytes) {
  ++activity;
  const Message message{std::move(bytes), client.id, ++client.last_number, lockstep_calendar()};
  bool elsewhere = false;
  for (Endpoint * other : named(client.name)) {
    if (other->kind != Kind::server || other->type != client.type) continue;
    if (other->local) enqueue(*other, message);
    else elsewhere = true;
  }
  elsewhere = elsewhere && client.announced;
  if (elsewhere) frames::send_request(message);
  sent(client, elsewhere);
  notify();
}

void Graph::respond(uint64_t client, int64_t number, Bytes bytes) {
  ++activity;
  const Message message{std::move(bytes), client, number, lockstep_calendar()};
  Endpoint * receiver = find(client);
  if (receiver && receiver->local) enqueue(*receiver, message);
  else if (receiver && joined_) frames::send_response(message);
  notify();
}

void Graph::enqueue(Endpoint & receiver, Message message) {
  ++activity;
  message.received = lockstep_calendar();
  receiver.queue.push_back(std::move(message));
  keep_last(receiver.queue, receiver);
  receiver.listener.tell();
}

bool Graph::take(Endpoint & receiver, Message & message) {
  while (!receiver.queue.empty()) {
    message = std::move(receiver.queue.front());
    receiver.queue.pop_front();
    ++activity;
    if (message.expires > lockstep_now()) return true;
  }
  return false;
}

}  // namespace rmw_lockstep
