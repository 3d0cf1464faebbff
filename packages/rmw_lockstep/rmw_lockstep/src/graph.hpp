// What this process knows of the ROS graph, and the delivery of messages between its endpoints.
//
// Call everything with the library's lock held (`Lock`).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "../lockstep/lockstep.h"
#include "endpoints.hpp"
#include "guards.hpp"

namespace rmw_lockstep {

class Lock {
public:
  Lock() { lockstep_lock(); }
  ~Lock() { if (held_) lockstep_unlock(); }
  void release() { lockstep_unlock(); held_ = false; }
  Lock(const Lock &) = delete;
  Lock & operator=(const Lock &) = delete;

private:
  bool held_ = true;
};

struct Node {
  uint64_t id = 0;
  std::string name, name_space;
  bool local = false;
  rmw_guard_condition_t * graph_changed = nullptr;
};

// A thread in rmw_wait, and what it waits for.
struct Waiter {
  rmw_subscriptions_t * subscriptions = nullptr;
  rmw_guard_conditions_t * guards = nullptr;
  rmw_services_t * services = nullptr;
  rmw_clients_t * clients = nullptr;
  rmw_events_t * events = nullptr;
  lockstep_waiter thread{};
  bool rests = false;    // guard conditions do not wake it
  bool ready(bool guards_count = true) const;
};

class Graph {
public:
  uint64_t new_id();

  // ---- what there is
  void add(std::unique_ptr<Node> node);
  void remove_node(uint64_t id);
  Endpoint & add(std::unique_ptr<Endpoint> endpoint);
  void remove(uint64_t id);
  const std::map<uint64_t, std::unique_ptr<Node>> & nodes() const { return nodes_; }
  const std::map<uint64_t, std::unique_ptr<Endpoint>> & endpoints() const { return endpoints_; }
  Endpoint * find(uint64_t id) const;
  std::vector<Endpoint *> named(const std::string & name) const;
  size_t matched(const Endpoint & endpoint) const;
  bool server_is_there(const Endpoint & client) const;

  // ---- messages
  void publish(Endpoint & publisher, Bytes bytes);
  void deliver(const Endpoint & publisher, const Message & message, uint64_t only = 0);
  void request(Endpoint & client, Bytes bytes);
  void respond(uint64_t client, int64_t number, Bytes bytes);
  void replayed(uint64_t publisher, uint64_t subscription);  // its next messages are new ones
  void enqueue(Endpoint & receiver, Message message);
  bool take(Endpoint & receiver, Message & message);

  // ---- time
  void assert_liveliness(Endpoint & publisher);
  void publisher_is_alive(uint64_t publisher);
  int64_t next_due() const;
  void due(int64_t now);

  // ---- waiting
  std::vector<Waiter *> waiters;
  uint64_t activity = 0;      // grows with everything that is sent, taken or received
  void notify();

  // ---- the hub
  void handle(const uint8_t * frame, size_t size);
  void announce(Endpoint & endpoint);
  void join();
  void forget_hub();

private:
  void changed();
  void match(Endpoint & one, Endpoint & other);
  void unmatch(Endpoint & stays, const Endpoint & goes);
  void matched_changed(Endpoint & endpoint, int by);
  void incompatible(Endpoint & endpoint, rmw_qos_policy_kind_t policy);
  void replay(Endpoint & publisher, const Endpoint & subscription);
  bool heard_elsewhere(const Endpoint & publisher) const;
  void sent(Endpoint & sender, bool elsewhere);
  void subscription_got(Endpoint & subscription, uint64_t publisher);
  void lose_publisher(Endpoint & subscription, Matched & publisher);

  std::map<uint64_t, std::unique_ptr<Node>> nodes_;
  std::map<uint64_t, std::unique_ptr<Endpoint>> endpoints_;
  std::unordered_map<std::string, std::vector<Endpoint *>> by_name_;
  uint64_t last_id_ = 0;
  int timed_ = 0;             // endpoints with a deadline or a lease
  volatile int complete_ = 0;
  bool joined_ = false;
};

Graph & graph();

}  // namespace rmw_lockstep
