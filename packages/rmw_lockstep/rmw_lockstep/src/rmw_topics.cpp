// Publishers and subscriptions.
#include "handles.hpp"
#include "rmw/dynamic_message_type_support.h"
#include "rmw/get_network_flow_endpoints.h"

using namespace rmw_lockstep;

namespace {

std::unique_ptr<Endpoint> endpoint_of(
    Kind kind, const rmw_node_t * node, const MessageType & type, const char * topic, const rmw_qos_profile_t & qos) {
  std::vector<rmw_qos_profile_t> peers;
  for (const Endpoint * other : graph().named(topic))
    if (other->is_topic() && other->kind != kind) peers.push_back(other->qos);
  auto made = local_endpoint(kind, node, type, topic, qos);
  made->id = graph().new_id();
  made->callbacks = type.callbacks;
  settle(made->qos, kind == Kind::subscription, peers);
  return made;
}

bool ignores_local(const rmw_publisher_options_t &) { return false; }
bool ignores_local(const rmw_subscription_options_t & options) { return options.ignore_local_publications; }

// Null, with rmw's error set, if something is missing or wrong.
template<typename Handle, typename Options>
Handle * create(
    Kind kind, Handle * (*allocate)(), const rmw_node_t * node, const rosidl_message_type_support_t * support,
    const char * topic, const rmw_qos_profile_t * qos, const Options * options) {
  REQUIRE_OR_NULL(node);
  REQUIRE_OR_NULL(support);
  REQUIRE_OR_NULL(topic);
  REQUIRE_OR_NULL(qos);
  REQUIRE_OR_NULL(options);
  MessageType type;
  if (!is_ours(node->implementation_identifier) || !valid_name("topic", topic, *qos) || !find_type(support, type)) return nullptr;
  if (options->require_unique_network_flow_endpoints == RMW_UNIQUE_NETWORK_FLOW_ENDPOINTS_STRICTLY_REQUIRED) {
    RMW_SET_ERROR_MSG("rmw_lockstep_cpp uses no network, so it has no network flow endpoints");
    return nullptr;
  }
  Handle * handle = named(allocate(), topic);
  handle->options = *options;
  handle->can_loan_messages = false;
  Lock lock;
  auto made = endpoint_of(kind, node, type, topic, *qos);
  made->ignores_local = ignores_local(*options);
  expect_endpoint();
  handle->data = &graph().add(std::move(made));
  return handle;
}

template<typename Handle>
rmw_ret_t count_matched(const Handle * handle, size_t * count) {
  REQUIRE_OURS(handle);
  REQUIRE(count);
  Lock lock;
  *count = graph().matched(of(handle));
  return RMW_RET_OK;
}

void describe(const Message & message, rmw_message_info_t & info) {
  info = rmw_get_zero_initialized_message_info();
  info.source_timestamp = message.sent;
  info.received_timestamp = message.received;
  info.publication_sequence_number = RMW_MESSAGE_INFO_SEQUENCE_NUMBER_UNSUPPORTED;
  info.reception_sequence_number = RMW_MESSAGE_INFO_SEQUENCE_NUMBER_UNSUPPORTED;
  info.publisher_gid.implementation_identifier = IDENTIFIER;
  write_gid(message.from, info.publisher_gid.data);
  info.from_intra_process = false;
}

bool take_message(const rmw_subscription_t * handle, Message & message, rmw_message_info_t * info) {
  Lock lock;
  expect_callback();
  if (!graph().take(of(handle), message)) return false;
  if (info) describe(message, *info);
  return true;
}

rmw_ret_t copy_bytes(const Bytes & bytes, rmw_serialized_message_t * out) {
  if (out->buffer_capacity < bytes->size() && rmw_serialized_message_resize(out, bytes->size()) != RMW_RET_OK)
    return RMW_RET_BAD_ALLOC;
  memcpy(out->buffer, bytes->data(), bytes->size());
  out->buffer_length = bytes->size();
  return RMW_RET_OK;
}

}  // namespace

// ---- publishers

RMW_LOCKSTEP_API rmw_publisher_t * rmw_create_publisher(
    const rmw_node_t * node, const rosidl_message_type_support_t * support, const char * topic,
    const rmw_qos_profile_t * qos, const rmw_publisher_options_t * options) {
  return create(Kind::publisher, rmw_publisher_allocate, node, support, topic, qos, options);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_publisher(rmw_node_t * node, rmw_publisher_t * handle) {
  return destroy(node, handle, rmw_publisher_free);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_publish(const rmw_publisher_t * handle, const void * message, rmw_publisher_allocation_t *) {
  REQUIRE_OURS(handle);
  REQUIRE(message);
  Bytes bytes = serialize(of(handle).callbacks, message);
  if (!bytes) return RMW_RET_ERROR;
  Lock lock;
  graph().publish(of(handle), std::move(bytes));
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_publish_serialized_message(
    const rmw_publisher_t * handle, const rmw_serialized_message_t * message, rmw_publisher_allocation_t *) {
  REQUIRE_OURS(handle);
  REQUIRE(message);
  auto bytes = std::make_shared<const std::vector<uint8_t>>(message->buffer, message->buffer + message->buffer_length);
  Lock lock;
  graph().publish(of(handle), std::move(bytes));
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_publisher_count_matched_subscriptions(const rmw_publisher_t * handle, size_t * count) {
  return count_matched(handle, count);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_publisher_get_actual_qos(const rmw_publisher_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_publisher_assert_liveliness(const rmw_publisher_t * handle) {
  REQUIRE_OURS(handle);
  Lock lock;
  graph().assert_liveliness(of(handle));
  return RMW_RET_OK;
}

// What is published has reached the hub, which loses nothing.
RMW_LOCKSTEP_API rmw_ret_t rmw_publisher_wait_for_all_acked(const rmw_publisher_t * handle, rmw_time_t) {
  REQUIRE_OURS(handle);
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_get_gid_for_publisher(const rmw_publisher_t * handle, rmw_gid_t * gid) {
  return gid_of(handle, gid);
}

// ---- subscriptions

RMW_LOCKSTEP_API rmw_subscription_t * rmw_create_subscription(
    const rmw_node_t * node, const rosidl_message_type_support_t * support, const char * topic,
    const rmw_qos_profile_t * qos, const rmw_subscription_options_t * options) {
  auto handle = create(Kind::subscription, rmw_subscription_allocate, node, support, topic, qos, options);
  if (handle) handle->is_cft_enabled = false;
  return handle;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_destroy_subscription(rmw_node_t * node, rmw_subscription_t * handle) {
  return destroy(node, handle, rmw_subscription_free);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_subscription_count_matched_publishers(const rmw_subscription_t * handle, size_t * count) {
  return count_matched(handle, count);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_subscription_get_actual_qos(const rmw_subscription_t * handle, rmw_qos_profile_t * qos) {
  return actual_qos(handle, qos);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_with_info(
    const rmw_subscription_t * handle, void * message, bool * taken, rmw_message_info_t * info,
    rmw_subscription_allocation_t *) {
  REQUIRE_OURS(handle);
  REQUIRE(message);
  REQUIRE(taken);
  Message got;
  *taken = take_message(handle, got, info);
  if (!*taken || deserialize(of(handle).callbacks, got.bytes->data(), got.bytes->size(), message)) return RMW_RET_OK;
  *taken = false;
  return RMW_RET_ERROR;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take(
    const rmw_subscription_t * handle, void * message, bool * taken, rmw_subscription_allocation_t * allocation) {
  return rmw_take_with_info(handle, message, taken, nullptr, allocation);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_sequence(
    const rmw_subscription_t * handle, size_t count, rmw_message_sequence_t * messages,
    rmw_message_info_sequence_t * infos, size_t * taken, rmw_subscription_allocation_t * allocation) {
  REQUIRE_OURS(handle);
  REQUIRE(messages);
  REQUIRE(infos);
  REQUIRE(taken);
  if (!count || count > messages->capacity || count > infos->capacity) {
    RMW_SET_ERROR_MSG("count is 0, or the sequences are too short");
    return RMW_RET_INVALID_ARGUMENT;
  }
  rmw_ret_t result = RMW_RET_OK;
  bool got = true;
  for (*taken = 0; *taken < count && got && result == RMW_RET_OK; *taken += got)
    result = rmw_take_with_info(handle, messages->data[*taken], &got, &infos->data[*taken], allocation);
  messages->size = infos->size = *taken;
  return result;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_serialized_message_with_info(
    const rmw_subscription_t * handle, rmw_serialized_message_t * message, bool * taken, rmw_message_info_t * info,
    rmw_subscription_allocation_t *) {
  REQUIRE_OURS(handle);
  REQUIRE(message);
  REQUIRE(taken);
  Message got;
  *taken = take_message(handle, got, info);
  return *taken ? copy_bytes(got.bytes, message) : RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_serialized_message(
    const rmw_subscription_t * handle, rmw_serialized_message_t * message, bool * taken,
    rmw_subscription_allocation_t * allocation) {
  return rmw_take_serialized_message_with_info(handle, message, taken, nullptr, allocation);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_subscription_set_on_new_message_callback(
    rmw_subscription_t * handle, rmw_event_callback_t callback, const void * data) {
  return set_listener(handle, callback, data);
}

// ---- serialization

RMW_LOCKSTEP_API rmw_ret_t rmw_serialize(
    const void * message, const rosidl_message_type_support_t * support, rmw_serialized_message_t * out) {
  REQUIRE(message);
  REQUIRE(out);
  MessageType type;
  if (!find_type(support, type)) return RMW_RET_ERROR;
  const Bytes bytes = serialize(type.callbacks, message);
  return bytes ? copy_bytes(bytes, out) : RMW_RET_ERROR;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_deserialize(
    const rmw_serialized_message_t * in, const rosidl_message_type_support_t * support, void * message) {
  REQUIRE(in);
  REQUIRE(message);
  MessageType type;
  if (!find_type(support, type)) return RMW_RET_ERROR;
  return deserialize(type.callbacks, in->buffer, in->buffer_length, message) ? RMW_RET_OK : RMW_RET_ERROR;
}
