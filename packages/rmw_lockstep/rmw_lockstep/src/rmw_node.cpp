// Nodes, and the guard conditions by which threads are woken.
#include "checks.hpp"
#include "graph.hpp"
#include "rmw/rmw.h"
#include "rmw/validate_namespace.h"
#include "rmw/validate_node_name.h"

using namespace rmw_lockstep;

namespace {

bool valid_names(const char * name, const char * name_space) {
  int result = 0;
  if (rmw_validate_node_name(name, &result, nullptr) != RMW_RET_OK) return false;
  if (result != RMW_NODE_NAME_VALID) {
    RMW_SET_ERROR_MSG_WITH_FORMAT_STRING("invalid node name: %s", rmw_node_name_validation_result_string(result));
    return false;
  }
  if (rmw_validate_namespace(name_space, &result, nullptr) != RMW_RET_OK) return false;
  if (result == RMW_NAMESPACE_VALID) return true;
  RMW_SET_ERROR_MSG_WITH_FORMAT_STRING("invalid node namespace: %s", rmw_namespace_validation_result_string(result));
  return false;
}

}  // namespace

RMW_LOCKSTEP_API rmw_node_t * rmw_create_node(rmw_context_t * context, const char * name, const char * name_space) {
  REQUIRE_OR_NULL(context);
  REQUIRE_OR_NULL(context->impl);
  REQUIRE_OR_NULL(name);
  REQUIRE_OR_NULL(name_space);
  if (!is_ours(context->implementation_identifier) || !valid_names(name, name_space)) return nullptr;
  rmw_node_t * handle = rmw_node_allocate();
  rmw_guard_condition_t * graph_changed = rmw_create_guard_condition(context);
  auto node = std::make_unique<Node>();
  handle->implementation_identifier = IDENTIFIER;
  handle->context = context;
  handle->name = copy_text(name);
  handle->namespace_ = copy_text(name_space);
  handle->data = node.get();
  node->name = name;
  node->name_space = name_space;
  node->local = true;
  node->graph_changed = graph_changed;
  Lock lock;
  node->id = graph().new_id();
  graph().add(std::move(node));
  return handle;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_node(rmw_node_t * handle) {
  REQUIRE_OURS(handle);
  rmw_guard_condition_t * graph_changed;
  {
    Lock lock;
    auto node = static_cast<Node *>(handle->data);
    graph_changed = node->graph_changed;
    graph().remove_node(node->id);
  }
  free_text(handle->name);
  free_text(handle->namespace_);
  rmw_node_free(handle);
  return rmw_destroy_guard_condition(graph_changed);
}

RMW_LOCKSTEP_API const rmw_guard_condition_t * rmw_node_get_graph_guard_condition(const rmw_node_t * handle) {
  return handle && is_ours(handle->implementation_identifier) ? static_cast<Node *>(handle->data)->graph_changed : nullptr;
}

RMW_LOCKSTEP_API rmw_guard_condition_t * rmw_create_guard_condition(rmw_context_t * context) {
  REQUIRE_OR_NULL(context);
  if (!is_ours(context->implementation_identifier)) return nullptr;
  rmw_guard_condition_t * handle = rmw_guard_condition_allocate();
  handle->implementation_identifier = IDENTIFIER;
  handle->context = context;
  handle->data = new Guard;
  return handle;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_guard_condition(rmw_guard_condition_t * handle) {
  REQUIRE_OURS(handle);
  {
    Lock lock;
    delete static_cast<Guard *>(handle->data);
  }
  rmw_guard_condition_free(handle);
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_trigger_guard_condition(const rmw_guard_condition_t * handle) {
  REQUIRE_OURS(handle);
  Lock lock;
  static_cast<Guard *>(handle->data)->trigger(lockstep_here().thread);
  graph().notify();
  return RMW_RET_OK;
}
