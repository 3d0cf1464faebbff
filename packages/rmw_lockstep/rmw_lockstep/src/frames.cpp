#include "frames.hpp"

#include "../lockstep/bytes.hpp"
#include "graph.hpp"
#include "qos.hpp"
#include "rmw/time.h"

namespace rmw_lockstep {
namespace {

using lockstep::Reader;
using lockstep::Writer;

template<typename Fill>
void send(char kind, Fill fill) {
  std::vector<uint8_t> frame;
  {
    Writer writer(frame, kind);
    fill(writer);
  }
  lockstep_send(frame.data(), frame.size());
}

void put_moment(Writer & writer) {
  const lockstep_moment here = lockstep_here();
  writer.put<uint64_t>(here.handled).put<int64_t>(here.now).put<uint32_t>(here.thread);
}

void put_qos(Writer & writer, const rmw_qos_profile_t & qos) {
  writer.put<uint8_t>(qos.history).put<uint32_t>(static_cast<uint32_t>(qos.depth)).put<uint8_t>(qos.reliability);
  writer.put<uint8_t>(qos.durability).put<uint8_t>(qos.liveliness);
  for (const rmw_time_t & time : {qos.deadline, qos.lifespan, qos.liveliness_lease_duration})
    writer.put<int64_t>(nanoseconds(time));
}

rmw_qos_profile_t get_qos(Reader & reader) {
  rmw_qos_profile_t qos{};
  qos.history = static_cast<rmw_qos_history_policy_t>(reader.get<uint8_t>());
  qos.depth = reader.get<uint32_t>();
  qos.reliability = static_cast<rmw_qos_reliability_policy_t>(reader.get<uint8_t>());
  qos.durability = static_cast<rmw_qos_durability_policy_t>(reader.get<uint8_t>());
  qos.liveliness = static_cast<rmw_qos_liveliness_policy_t>(reader.get<uint8_t>());
  for (rmw_time_t * time : {&qos.deadline, &qos.lifespan, &qos.liveliness_lease_duration}) {
    const auto duration = reader.get<int64_t>();
    const rmw_time_t infinite = RMW_DURATION_INFINITE;
    *time = duration == FOREVER ? infinite : rmw_time_from_nsec(duration);
  }
  return qos;
}

Bytes rest_of(const Reader & reader) {
  return std::make_shared<const std::vector<uint8_t>>(reader.rest(), reader.rest() + reader.left());
}

void handle_node(Reader & reader) {
  auto node = std::make_unique<Node>();
  node->id = reader.get<uint64_t>();
  node->name = reader.text();
  node->name_space = reader.text();
  if (reader.ok()) graph().add(std::move(node));
}

void handle_endpoint(Reader & reader) {
  auto endpoint = std::make_unique<Endpoint>();
  endpoint->id = reader.get<uint64_t>();
  endpoint->kind = static_cast<Kind>(reader.get<uint8_t>());
  endpoint->node = reader.get<uint64_t>();
  endpoint->name = reader.text();
  endpoint->type = reader.text();
  endpoint->hash.version = reader.get<uint8_t>();
  reader.raw(endpoint->hash.value, sizeof endpoint->hash.value);
  endpoint->qos = get_qos(reader);
  if (reader.ok() && !graph().find(endpoint->id)) graph().add(std::move(endpoint));
}

void handle_data(Reader & reader) {
  const auto publisher = reader.get<uint64_t>(), only = reader.get<uint64_t>();
  Message message;
  message.from = publisher;
  message.sent = reader.get<int64_t>();
  const Endpoint * from = graph().find(publisher);
  if (!reader.ok() || !from) return;
  message.bytes = rest_of(reader);
  graph().deliver(*from, message, only);
}

void handle_replayed(Reader & reader) {
  const auto publisher = reader.get<uint64_t>(), subscription = reader.get<uint64_t>();
  if (reader.ok()) graph().replayed(publisher, subscription);
}

// To a server: its identity, the client's, the number. To a client: its identity and the number.
void handle_call(Reader & reader, Kind kind) {
  Endpoint * receiver = graph().find(reader.get<uint64_t>());
  Message message;
  if (kind == Kind::server) message.from = reader.get<uint64_t>();
  message.number = reader.get<int64_t>();
  message.sent = reader.get<int64_t>();
  if (!reader.ok() || !receiver || !receiver->local || receiver->kind != kind) return;
  message.bytes = rest_of(reader);
  graph().enqueue(*receiver, std::move(message));
}

}  // namespace

namespace frames {

void send_join() { send('J', [](Writer &) {}); }

void send_node(const Node & node) {
  send('N', [&](Writer & writer) { writer.put<uint64_t>(node.id).text(node.name).text(node.name_space); });
}

void send_endpoint(const Endpoint & endpoint) {
  send('E', [&](Writer & writer) {
    writer.put<uint64_t>(endpoint.id).put<uint8_t>(static_cast<uint8_t>(endpoint.kind)).put<uint64_t>(endpoint.node);
    writer.text(endpoint.name).text(endpoint.type).put<uint8_t>(endpoint.hash.version);
    writer.raw(endpoint.hash.value, sizeof endpoint.hash.value);
    put_qos(writer, endpoint.qos);
  });
}

void send_gone(char kind, uint64_t id) {
  send(kind, [&](Writer & writer) { writer.put<uint64_t>(id); });
}

void send_alive(uint64_t publisher) { send_gone('L', publisher); }

void send_data(uint64_t publisher, uint64_t only, const Message & message) {
  send('D', [&](Writer & writer) {
    writer.put<uint64_t>(publisher).put<uint64_t>(only).put<int64_t>(message.sent);
    put_moment(writer);
    writer.raw(message.bytes->data(), message.bytes->size());
  });
  lockstep_sent_output();
}

void send_replayed(uint64_t publisher, uint64_t subscription) {
  send('r', [&](Writer & writer) { writer.put<uint64_t>(publisher).put<uint64_t>(subscription); });
}

void send_kept(uint64_t sender, uint32_t count) {
  send('K', [&](Writer & writer) {
    writer.put<uint64_t>(sender).put<uint32_t>(count);
    put_moment(writer);
  });
}

namespace {

void send_call(char kind, const Message & message) {
  send(kind, [&](Writer & writer) {
    writer.put<uint64_t>(message.from).put<int64_t>(message.number).put<int64_t>(message.sent);
    put_moment(writer);
    writer.raw(message.bytes->data(), message.bytes->size());
  });
  lockstep_sent_output();
}

}  // namespace

void send_request(const Message & message) { send_call('Q', message); }
void send_response(const Message & message) { send_call('R', message); }

}  // namespace frames

// ---- the graph's end of the connection

void Graph::handle(const uint8_t * frame, size_t size) {
  Reader reader(frame + 1, size - 1);
  ++activity;
  switch (frame[0]) {
    case 'N': handle_node(reader); break;
    case 'n': remove_node(reader.get<uint64_t>()); break;
    case 'E': handle_endpoint(reader); break;
    case 'e': remove(reader.get<uint64_t>()); break;
    case 'g': complete_ = 1; break;
    case 'D': handle_data(reader); break;
    case 'r': handle_replayed(reader); break;
    case 'Q': handle_call(reader, Kind::server); break;
    case 'R': handle_call(reader, Kind::client); break;
    case 'L': publisher_is_alive(reader.get<uint64_t>()); break;
    default: break;
  }
  notify();
}

void Graph::join() {
  if (joined_ || !lockstep_connected()) return;
  static const lockstep_participant participant{
      [](const uint8_t * frame, size_t size) { graph().handle(frame, size); },
      [] { return graph().next_due(); },
      [](int64_t now) { graph().due(now); },
      [] { return static_cast<uint32_t>(graph().waiters.size()); },
      [] { graph().forget_hub(); },
  };
  lockstep_participate(&participant);
  joined_ = true;
  complete_ = 0;
  frames::send_join();
  lockstep_block_until(&complete_);
}

// Called in the child of a fork: what was announced belongs to the parent, and the child starts with its own graph.
void Graph::forget_hub() {
  joined_ = false;
  complete_ = 0;
  waiters.clear();
  std::vector<uint64_t> nodes, ends;
  for (auto & [id, node] : nodes_) if (!node->local) nodes.push_back(id);
  for (auto & [id, endpoint] : endpoints_) {
    endpoint->announced = false;
    if (!endpoint->local) ends.push_back(id);
  }
  for (const uint64_t id : ends) remove(id);
  for (const uint64_t id : nodes) nodes_.erase(id);
}

}  // namespace rmw_lockstep
