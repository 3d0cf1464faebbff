// The frames about the graph and its messages, to and from the hub: see PROTOCOL.md.
#pragma once

#include "endpoints.hpp"

namespace rmw_lockstep {

struct Node;

namespace frames {

void send_join();
void send_node(const Node & node);
void send_endpoint(const Endpoint & endpoint);
void send_gone(char kind, uint64_t id);
void send_alive(uint64_t publisher);
void send_data(uint64_t publisher, uint64_t only, const Message & message);
void send_replayed(uint64_t publisher, uint64_t subscription);
void send_kept(uint64_t sender, uint32_t count);
void send_request(const Message & message);
void send_response(const Message & message);

}  // namespace frames
}  // namespace rmw_lockstep
