// Publishers, subscriptions, service servers and clients: of this process, and of others as the hub reports them.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

#include "rmw/event.h"
#include "rmw/event_callback_type.h"
#include "rmw/events_statuses/events_statuses.h"
#include "rmw/types.h"
#include "types.hpp"

namespace rmw_lockstep {

enum class Kind : uint8_t { publisher, subscription, server, client };

struct Message {
  Bytes bytes;
  uint64_t from = 0;      // publisher or client
  int64_t number = 0;     // of a request, or of the request that it answers
  int64_t sent = 0;       // calendar time (ns)
  int64_t received = 0;   // calendar time (ns)
  int64_t expires = INT64_MAX;  // steady time (ns)
};

// A callback for data or events, and the count of those that came before it was set.
struct Listener {
  rmw_event_callback_t function = nullptr;
  const void * data = nullptr;
  size_t unheard = 0;
  void tell();
  void set(rmw_event_callback_t function, const void * data);
};

// What has happened to an endpoint of this process, in the structures in which rmw returns it.
struct Events {
  std::array<bool, RMW_EVENT_INVALID> pending{};
  std::array<Listener, RMW_EVENT_INVALID> listeners{};
  rmw_matched_status_t matched{};
  rmw_qos_incompatible_event_status_t incompatible_qos{0, 0, RMW_QOS_POLICY_INVALID};
  rmw_incompatible_type_status_t incompatible_type{};
  rmw_liveliness_changed_status_t liveliness_changed{};
  rmw_liveliness_lost_status_t liveliness_lost{};
  rmw_requested_deadline_missed_status_t requested_deadline{};
  rmw_offered_deadline_missed_status_t offered_deadline{};
  rmw_message_lost_status_t message_lost{};
  void raise(rmw_event_type_t type);
};

// A publisher as one subscription sees it: whether it is alive, by hand, and since when (steady time, ns); and whether
// what it has kept for late joiners is still on its way, and with it all that it publishes meanwhile.
struct Matched { bool asserted = false, alive = false; int64_t until = INT64_MAX; bool replays = false; };

struct Endpoint {
  uint64_t id = 0;
  Kind kind = Kind::publisher;
  uint64_t node = 0;
  std::string name, type;
  rosidl_type_hash_t hash{};
  rmw_qos_profile_t qos{};

  // Of this process's own only:
  bool local = false;
  bool announced = false;        // the hub knows it
  bool ignores_local = false;
  Callbacks callbacks = nullptr, answer_callbacks = nullptr;
  int64_t last_number = 0;       // of the last one that it sent
  uint32_t kept_here = 0;        // how many it sent at one moment, unknown to the hub: see `Graph::sent`
  int64_t kept_at = 0;           // that moment (steady time, ns)
  std::deque<Message> queue;     // what has arrived and was not taken
  std::deque<Message> history;   // what a transient-local publisher keeps for late joiners
  Listener listener;             // of data
  Events events;
  std::map<uint64_t, Matched> publishers;  // of this subscription
  int64_t next_deadline = INT64_MAX;     // by which the next message is due (steady time, ns)
  int64_t alive_until = INT64_MAX;       // of a publisher whose liveliness is asserted by hand
  bool asserted = false;

  bool is_topic() const { return kind == Kind::publisher || kind == Kind::subscription; }
};

inline bool same_topic(const Endpoint & one, const Endpoint & other) {
  return one.is_topic() && other.is_topic() && one.kind != other.kind && one.name == other.name;
}

// The 16 bytes by which ROS 2 distinguishes endpoints.
void write_gid(uint64_t id, uint8_t * gid);
uint64_t id_of(const uint8_t * gid);

}  // namespace rmw_lockstep
