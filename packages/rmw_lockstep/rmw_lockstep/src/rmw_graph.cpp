// Queries of the graph.
#include <map>
#include <set>

#include "checks.hpp"
#include "graph.hpp"
#include "rcutils/strdup.h"
#include "rmw/get_node_info_and_types.h"
#include "rmw/get_service_names_and_types.h"
#include "rmw/get_topic_endpoint_info.h"
#include "rmw/get_topic_names_and_types.h"
#include "rmw/names_and_types.h"
#include "rmw/rmw.h"
#include "rmw/topic_endpoint_info.h"
#include "rmw/topic_endpoint_info_array.h"
#include "rmw/validate_full_topic_name.h"
#include "rmw/validate_namespace.h"
#include "rmw/validate_node_name.h"

using namespace rmw_lockstep;

namespace {

using Names = std::map<std::string, std::set<std::string>>;

rmw_ret_t give(const Names & names, rcutils_allocator_t * allocator, rmw_names_and_types_t * out) {
  if (names.empty()) return RMW_RET_OK;
  const rmw_ret_t result = rmw_names_and_types_init(out, names.size(), allocator);
  if (result != RMW_RET_OK) return result;
  size_t i = 0;
  for (const auto & [name, types] : names) {
    out->names.data[i] = rcutils_strdup(name.c_str(), *allocator);
    if (rcutils_string_array_init(&out->types[i], types.size(), allocator) != RCUTILS_RET_OK) return RMW_RET_BAD_ALLOC;
    size_t j = 0;
    for (const std::string & type : types) out->types[i].data[j++] = rcutils_strdup(type.c_str(), *allocator);
    ++i;
  }
  return RMW_RET_OK;
}

rmw_ret_t check(const rmw_node_t * node, rcutils_allocator_t * allocator, rmw_names_and_types_t * out) {
  REQUIRE_OURS(node);
  REQUIRE(out);
  if (!allocator || !rcutils_allocator_is_valid(allocator)) {
    RMW_SET_ERROR_MSG("allocator is not valid");
    return RMW_RET_INVALID_ARGUMENT;
  }
  return rmw_names_and_types_check_zero(out);
}

rmw_ret_t all_names(const rmw_node_t * node, rcutils_allocator_t * allocator, rmw_names_and_types_t * out, bool topics) {
  const rmw_ret_t checked = check(node, allocator, out);
  if (checked != RMW_RET_OK) return checked;
  Names names;
  {
    Lock lock;
    for (const auto & [_, endpoint] : graph().endpoints())
      if (topics ? endpoint->is_topic() : endpoint->kind == Kind::server) names[endpoint->name].insert(endpoint->type);
  }
  return give(names, allocator, out);
}

rmw_ret_t valid_node(const char * name, const char * name_space) {
  REQUIRE(name);
  REQUIRE(name_space);
  int name_result = 0, space_result = 0;
  if (rmw_validate_node_name(name, &name_result, nullptr) == RMW_RET_OK && name_result == RMW_NODE_NAME_VALID &&
      rmw_validate_namespace(name_space, &space_result, nullptr) == RMW_RET_OK && space_result == RMW_NAMESPACE_VALID)
    return RMW_RET_OK;
  RMW_SET_ERROR_MSG("the node's name or namespace is not valid");
  return RMW_RET_INVALID_ARGUMENT;
}

rmw_ret_t names_of(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * name, const char * name_space,
    rmw_names_and_types_t * out, Kind kind) {
  rmw_ret_t checked = check(node, allocator, out);
  if (checked == RMW_RET_OK) checked = valid_node(name, name_space);
  if (checked != RMW_RET_OK) return checked;
  std::set<uint64_t> nodes;
  Names names;
  {
    Lock lock;
    for (const auto & [id, other] : graph().nodes())
      if (other->name == name && other->name_space == name_space) nodes.insert(id);
    for (const auto & [_, endpoint] : graph().endpoints())
      if (endpoint->kind == kind && nodes.count(endpoint->node)) names[endpoint->name].insert(endpoint->type);
  }
  if (!nodes.empty()) return give(names, allocator, out);
  RMW_SET_ERROR_MSG("there is no such node");
  return RMW_RET_NODE_NAME_NON_EXISTENT;
}

rmw_ret_t count(const rmw_node_t * node, const char * name, size_t * number, Kind kind) {
  REQUIRE_OURS(node);
  REQUIRE(name);
  REQUIRE(number);
  int result = 0;
  if (rmw_validate_full_topic_name(name, &result, nullptr) != RMW_RET_OK || result != RMW_TOPIC_VALID) {
    RMW_SET_ERROR_MSG("the name is not valid");
    return RMW_RET_INVALID_ARGUMENT;
  }
  Lock lock;
  *number = 0;
  for (const Endpoint * endpoint : graph().named(name)) *number += endpoint->kind == kind;
  return RMW_RET_OK;
}

struct Named { const Endpoint * endpoint; std::string node, name_space; };

rmw_ret_t describe(const Named & named, rcutils_allocator_t * allocator, rmw_topic_endpoint_info_t * info) {
  const Endpoint & endpoint = *named.endpoint;
  uint8_t gid[RMW_GID_STORAGE_SIZE];
  write_gid(endpoint.id, gid);
  const auto type = endpoint.kind == Kind::publisher ? RMW_ENDPOINT_PUBLISHER : RMW_ENDPOINT_SUBSCRIPTION;
  for (const rmw_ret_t result : {
           rmw_topic_endpoint_info_set_node_name(info, named.node.c_str(), allocator),
           rmw_topic_endpoint_info_set_node_namespace(info, named.name_space.c_str(), allocator),
           rmw_topic_endpoint_info_set_topic_type(info, endpoint.type.c_str(), allocator),
           rmw_topic_endpoint_info_set_topic_type_hash(info, &endpoint.hash),
           rmw_topic_endpoint_info_set_endpoint_type(info, type),
           rmw_topic_endpoint_info_set_gid(info, gid, sizeof gid),
           rmw_topic_endpoint_info_set_qos_profile(info, &endpoint.qos)})
    if (result != RMW_RET_OK) return result;
  return RMW_RET_OK;
}

Named with_node(const Endpoint & endpoint) {
  const auto found = graph().nodes().find(endpoint.node);
  if (found == graph().nodes().end()) return {&endpoint, "_NODE_NAME_UNKNOWN_", "_NODE_NAMESPACE_UNKNOWN_"};
  return {&endpoint, found->second->name, found->second->name_space};
}

rmw_ret_t infos(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * topic, rmw_topic_endpoint_info_array_t * out,
    Kind kind) {
  REQUIRE_OURS(node);
  REQUIRE(topic);
  REQUIRE(out);
  if (!allocator || !rcutils_allocator_is_valid(allocator)) {
    RMW_SET_ERROR_MSG("allocator is not valid");
    return RMW_RET_INVALID_ARGUMENT;
  }
  rmw_ret_t result = rmw_topic_endpoint_info_array_check_zero(out);
  if (result != RMW_RET_OK) return result;
  Lock lock;
  std::vector<Named> found;
  for (const Endpoint * endpoint : graph().named(topic))
    if (endpoint->kind == kind) found.push_back(with_node(*endpoint));
  if (found.empty()) return RMW_RET_OK;
  result = rmw_topic_endpoint_info_array_init_with_size(out, found.size(), allocator);
  for (size_t i = 0; result == RMW_RET_OK && i < found.size(); ++i)
    result = describe(found[i], allocator, &out->info_array[i]);
  if (result != RMW_RET_OK && rmw_topic_endpoint_info_array_fini(out, allocator) != RMW_RET_OK) return RMW_RET_ERROR;
  return result;
}

}  // namespace

RMW_LOCKSTEP_API rmw_ret_t rmw_get_topic_names_and_types(
    const rmw_node_t * node, rcutils_allocator_t * allocator, bool, rmw_names_and_types_t * out) {
  return all_names(node, allocator, out, true);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_service_names_and_types(
    const rmw_node_t * node, rcutils_allocator_t * allocator, rmw_names_and_types_t * out) {
  return all_names(node, allocator, out, false);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_publisher_names_and_types_by_node(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * name, const char * name_space, bool,
    rmw_names_and_types_t * out) {
  return names_of(node, allocator, name, name_space, out, Kind::publisher);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_subscriber_names_and_types_by_node(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * name, const char * name_space, bool,
    rmw_names_and_types_t * out) {
  return names_of(node, allocator, name, name_space, out, Kind::subscription);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_service_names_and_types_by_node(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * name, const char * name_space,
    rmw_names_and_types_t * out) {
  return names_of(node, allocator, name, name_space, out, Kind::server);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_client_names_and_types_by_node(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * name, const char * name_space,
    rmw_names_and_types_t * out) {
  return names_of(node, allocator, name, name_space, out, Kind::client);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_node_names_with_enclaves(
    const rmw_node_t * node, rcutils_string_array_t * names, rcutils_string_array_t * name_spaces,
    rcutils_string_array_t * enclaves) {
  REQUIRE_OURS(node);
  REQUIRE(names);
  REQUIRE(name_spaces);
  rcutils_allocator_t allocator = rcutils_get_default_allocator();
  Lock lock;
  const auto & nodes = graph().nodes();
  for (rcutils_string_array_t * array : {names, name_spaces, enclaves})
    if (array && rcutils_string_array_init(array, nodes.size(), &allocator) != RCUTILS_RET_OK) return RMW_RET_BAD_ALLOC;
  size_t i = 0;
  for (const auto & [_, each] : nodes) {
    names->data[i] = rcutils_strdup(each->name.c_str(), allocator);
    name_spaces->data[i] = rcutils_strdup(each->name_space.c_str(), allocator);
    if (enclaves) enclaves->data[i] = rcutils_strdup("/", allocator);
    ++i;
  }
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_node_names(
    const rmw_node_t * node, rcutils_string_array_t * names, rcutils_string_array_t * name_spaces) {
  return rmw_get_node_names_with_enclaves(node, names, name_spaces, nullptr);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_count_publishers(const rmw_node_t * node, const char * name, size_t * number) {
  return count(node, name, number, Kind::publisher);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_count_subscribers(const rmw_node_t * node, const char * name, size_t * number) {
  return count(node, name, number, Kind::subscription);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_count_clients(const rmw_node_t * node, const char * name, size_t * number) {
  return count(node, name, number, Kind::client);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_count_services(const rmw_node_t * node, const char * name, size_t * number) {
  return count(node, name, number, Kind::server);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_publishers_info_by_topic(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * topic, bool,
    rmw_topic_endpoint_info_array_t * out) {
  return infos(node, allocator, topic, out, Kind::publisher);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_subscriptions_info_by_topic(
    const rmw_node_t * node, rcutils_allocator_t * allocator, const char * topic, bool,
    rmw_topic_endpoint_info_array_t * out) {
  return infos(node, allocator, topic, out, Kind::subscription);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_compare_gids_equal(const rmw_gid_t * one, const rmw_gid_t * other, bool * equal) {
  REQUIRE_OURS(one);
  REQUIRE_OURS(other);
  REQUIRE(equal);
  *equal = memcmp(one->data, other->data, RMW_GID_STORAGE_SIZE) == 0;
  return RMW_RET_OK;
}
