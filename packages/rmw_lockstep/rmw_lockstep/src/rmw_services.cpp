// Service servers and clients; actions are made of them.
#include "handles.hpp"

using namespace rmw_lockstep;

namespace {

// Null, with rmw's error set, if something is missing or wrong.
std::unique_ptr<Endpoint> endpoint_of(
    Kind kind, const rmw_node_t * node, const rosidl_service_type_support_t * support, const char * name,
    const rmw_qos_profile_t * qos) {
  REQUIRE_OR_NULL(node);
  REQUIRE_OR_NULL(support);
  REQUIRE_OR_NULL(name);
  REQUIRE_OR_NULL(qos);
  ServiceType type;
  if (!is_ours(node->implementation_identifier) || !valid_name("service", name, *qos) || !find_type(support, type)) return nullptr;
  auto made = local_endpoint(kind, node, type, name, *qos);
  made->callbacks = type.request;
  made->answer_callbacks = type.response;
  settle(made->qos, false, {});
  return made;
}

// Null, with rmw's error set, if something is missing or wrong.
template<typename Handle>
Handle * create(
    Kind kind, Handle * (*allocate)(), const rmw_node_t * node, const rosidl_service_type_support_t * support,
    const char * name, const rmw_qos_profile_t * qos) {
  auto made = endpoint_of(kind, node, support, name, qos);
  if (!made) return nullptr;
  Handle * handle = named(allocate(), name);
  Lock lock;
  made->id = graph().new_id();
  expect_endpoint();
  handle->data = &graph().add(std::move(made));
  return handle;
}

rmw_ret_t take_call(Endpoint & endpoint, Callbacks callbacks, rmw_service_info_t * info, void * out, bool * taken) {
  REQUIRE(info);
  REQUIRE(out);
  REQUIRE(taken);
  Message message;
  {
    Lock lock;
    expect_callback();
    *taken = graph().take(endpoint, message);
  }
  if (!*taken) return RMW_RET_OK;
  info->source_timestamp = message.sent;
  info->received_timestamp = message.received;
  info->request_id.sequence_number = message.number;
  write_gid(message.from, reinterpret_cast<uint8_t *>(info->request_id.writer_guid));
  if (deserialize(callbacks, message.bytes->data(), message.bytes->size(), out)) return RMW_RET_OK;
  *taken = false;
  return RMW_RET_ERROR;
}

}  // namespace

// ---- clients

RMW_LOCKSTEP_API rmw_client_t * rmw_create_client(
    const rmw_node_t * node, const rosidl_service_type_support_t * support, const char * name,
    const rmw_qos_profile_t * qos) {
  return create(Kind::client, rmw_client_allocate, node, support, name, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_client(rmw_node_t * node, rmw_client_t * handle) {
  return destroy(node, handle, rmw_client_free);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_send_request(const rmw_client_t * handle, const void * request, int64_t * number) {
  REQUIRE_OURS(handle);
  REQUIRE(request);
  REQUIRE(number);
  Bytes bytes = serialize(of(handle).callbacks, request);
  if (!bytes) return RMW_RET_ERROR;
  Lock lock;
  *number = of(handle).last_number + 1;
  graph().request(of(handle), std::move(bytes));
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_response(
    const rmw_client_t * handle, rmw_service_info_t * info, void * response, bool * taken) {
  REQUIRE_OURS(handle);
  return take_call(of(handle), of(handle).answer_callbacks, info, response, taken);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_service_server_is_available(
    const rmw_node_t * node, const rmw_client_t * handle, bool * is_available) {
  REQUIRE_OURS(node);
  REQUIRE_OURS(handle);
  REQUIRE(is_available);
  Lock lock;
  *is_available = graph().server_is_there(of(handle));
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_gid_for_client(const rmw_client_t * handle, rmw_gid_t * gid) {
  return gid_of(handle, gid);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_client_set_on_new_response_callback(
    rmw_client_t * handle, rmw_event_callback_t callback, const void * data) {
  return set_listener(handle, callback, data);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_client_request_publisher_get_actual_qos(const rmw_client_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_client_response_subscription_get_actual_qos(
    const rmw_client_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}

// ---- servers

RMW_LOCKSTEP_API rmw_service_t * rmw_create_service(
    const rmw_node_t * node, const rosidl_service_type_support_t * support, const char * name,
    const rmw_qos_profile_t * qos) {
  return create(Kind::server, rmw_service_allocate, node, support, name, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_service(rmw_node_t * node, rmw_service_t * handle) {
  return destroy(node, handle, rmw_service_free);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_request(
    const rmw_service_t * handle, rmw_service_info_t * info, void * request, bool * taken) {
  REQUIRE_OURS(handle);
  return take_call(of(handle), of(handle).callbacks, info, request, taken);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_send_response(const rmw_service_t * handle, rmw_request_id_t * request, void * response) {
  REQUIRE_OURS(handle);
  REQUIRE(request);
  REQUIRE(response);
  Bytes bytes = serialize(of(handle).answer_callbacks, response);
  if (!bytes) return RMW_RET_ERROR;
  Lock lock;
  graph().respond(id_of(reinterpret_cast<uint8_t *>(request->writer_guid)), request->sequence_number, std::move(bytes));
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_service_set_on_new_request_callback(
    rmw_service_t * handle, rmw_event_callback_t callback, const void * data) {
  return set_listener(handle, callback, data);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_service_request_subscription_get_actual_qos(
    const rmw_service_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_service_response_publisher_get_actual_qos(
    const rmw_service_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}
