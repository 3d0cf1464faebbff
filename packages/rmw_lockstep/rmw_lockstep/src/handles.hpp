// What publishers, subscriptions, clients and servers have in common as rmw hands them out: their data is an endpoint.
#pragma once

#include "checks.hpp"
#include "graph.hpp"
#include "names.hpp"
#include "qos.hpp"
#include "rmw/rmw.h"

namespace rmw_lockstep {

template<typename Handle>
Endpoint & of(const Handle * handle) { return *static_cast<Endpoint *>(handle->data); }

template<typename Handle>
auto name_of(Handle & handle) -> decltype((handle.topic_name)) { return handle.topic_name; }

template<typename Handle>
auto name_of(Handle & handle) -> decltype((handle.service_name)) { return handle.service_name; }

// An endpoint of this process, which no graph has yet.
template<typename Type>
std::unique_ptr<Endpoint> local_endpoint(
    Kind kind, const rmw_node_t * node, const Type & type, const char * name, const rmw_qos_profile_t & qos) {
  auto made = std::make_unique<Endpoint>();
  made->kind = kind;
  made->local = true;
  made->node = static_cast<Node *>(node->data)->id;
  made->name = name;
  made->type = type.name;
  made->hash = type.hash;
  made->qos = qos;
  return made;
}

template<typename Handle>
Handle * named(Handle * handle, const char * name) {
  handle->implementation_identifier = IDENTIFIER;
  name_of(*handle) = copy_text(name);
  return handle;
}

template<typename Handle>
rmw_ret_t destroy(const rmw_node_t * node, Handle * handle, void (*free)(Handle *)) {
  REQUIRE_OURS(node);
  REQUIRE_OURS(handle);
  {
    Lock lock;
    graph().remove(of(handle).id);
  }
  free_text(name_of(*handle));
  free(handle);
  return RMW_RET_OK;
}

template<typename Handle>
rmw_ret_t actual_qos(const Handle * handle, rmw_qos_profile_t * qos) {
  REQUIRE_OURS(handle);
  REQUIRE(qos);
  *qos = of(handle).qos;
  return RMW_RET_OK;
}

template<typename Handle>
rmw_ret_t gid_of(const Handle * handle, rmw_gid_t * gid) {
  REQUIRE_OURS(handle);
  REQUIRE(gid);
  gid->implementation_identifier = IDENTIFIER;
  write_gid(of(handle).id, gid->data);
  return RMW_RET_OK;
}

template<typename Handle>
rmw_ret_t set_listener(Handle * handle, rmw_event_callback_t callback, const void * data) {
  REQUIRE_OURS(handle);
  Lock lock;
  of(handle).listener.set(callback, data);
  return RMW_RET_OK;
}

}  // namespace rmw_lockstep
