// All that this process knows of the ROS graph, and what passes between its end points.
//
// Everything is called with the library's lock held (`Lock`).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "../lockstep/lockstep.h"
#include "end_points.hpp"
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
  EndPoint & add(std::unique_ptr<EndPoint> end_point);
  void remove(uint64_t id);
  const std::map<uint64_t, std::unique_ptr<Node>> & nodes() const { return nodes_; }
  const std::map<uint64_t, std::unique_ptr<EndPoint>> & end_points() const { return end_points_; }
  EndPoint * find(uint64_t id) const;
  std::vector<EndPoint *> named(const std::string & name) const;
  size_t matched(const EndPoint & end_point) const;
  bool server_is_there(const EndPoint & client) const;

  // ---- messages
  void publish(EndPoint & publisher, Bytes bytes);
  void deliver(const EndPoint & publisher, const Message & message, uint64_t only = 0);
  void request(EndPoint & client, Bytes bytes);
  void respond(uint64_t client, int64_t number, Bytes bytes);
  void replayed(uint64_t publisher, uint64_t subscription);  // what comes from it now is new
  void enqueue(EndPoint & receiver, Message message);
  bool take(EndPoint & receiver, Message & message);

  // ---- time
  void assert_liveliness(EndPoint & publisher);
  void publisher_is_alive(uint64_t publisher);
  int64_t next_due() const;
  void due(int64_t now);

  // ---- waiting
  std::vector<Waiter *> waiters;
  uint64_t activity = 0;      // grows with everything that is sent, taken or received
  void notify();

  // ---- the hub
  void handle(const uint8_t * frame, size_t size);
  void announce(EndPoint & end_point);
  void join();
  void forget_hub();

private:
  void changed();
  void match(EndPoint & one, EndPoint & other);
  void unmatch(EndPoint & stays, const EndPoint & goes);
  void matched_changed(EndPoint & end_point, int by);
  void incompatible(EndPoint & end_point, rmw_qos_policy_kind_t policy);
  void replay(EndPoint & publisher, const EndPoint & subscription);
  bool heard_elsewhere(const EndPoint & publisher) const;
  void sent(EndPoint & sender, bool elsewhere);
  void subscription_got(EndPoint & subscription, uint64_t publisher);
  void lose_publisher(EndPoint & subscription, Matched & publisher);

  std::map<uint64_t, std::unique_ptr<Node>> nodes_;
  std::map<uint64_t, std::unique_ptr<EndPoint>> end_points_;
  std::unordered_map<std::string, std::vector<EndPoint *>> by_name_;
  uint64_t last_id_ = 0;
  int timed_ = 0;             // end points with a deadline or a lease
  volatile int complete_ = 0;
  bool joined_ = false;
};

Graph & graph();

}  // namespace rmw_lockstep
