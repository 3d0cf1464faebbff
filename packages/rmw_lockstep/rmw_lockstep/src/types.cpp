#include "types.hpp"

#include "fastcdr/Cdr.h"
#include "fastcdr/FastBuffer.h"
#include "rcutils/error_handling.h"
#include "rmw/error_handling.h"
#include "rosidl_typesupport_fastrtps_c/identifier.h"
#include "rosidl_typesupport_fastrtps_cpp/identifier.hpp"

namespace rmw_lockstep {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// C's generated code first, which Python uses; otherwise C++'s.
template<typename Support, typename Find>
const Support * find_handle(const Support * support, Find find) {
  if (auto found = find(support, rosidl_typesupport_fastrtps_c__identifier)) return found;
  rcutils_reset_error();
  if (auto found = find(support, rosidl_typesupport_fastrtps_cpp::typesupport_identifier)) return found;
  rcutils_reset_error();
  RMW_SET_ERROR_MSG("the message package has no code for rosidl_typesupport_fastrtps");
  return nullptr;
}

// "sensor_msgs::msg" (C++) or "sensor_msgs__msg" (C), and "JointState".
std::string type_name(const char * name_space, const char * name) {
  const std::string text(name_space);
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const std::string pair = text.substr(i, 2);
    if (pair == "::" || pair == "__") { out += '/'; ++i; }
    else out += text[i];
  }
  return out + "/" + name;
}

Callbacks callbacks_of(const rosidl_message_type_support_t * support) {
  auto handle = find_handle(support, get_message_typesupport_handle);
  return handle ? static_cast<Callbacks>(handle->data) : nullptr;
}

}  // namespace

bool find_type(const rosidl_message_type_support_t * support, MessageType & type) {
  type.callbacks = callbacks_of(support);
  if (!type.callbacks) return false;
  type.name = type_name(type.callbacks->message_namespace_, type.callbacks->message_name_);
  if (support->get_type_hash_func) type.hash = *support->get_type_hash_func(support);
  return true;
}

bool find_type(const rosidl_service_type_support_t * support, ServiceType & type) {
  auto handle = find_handle(support, get_service_typesupport_handle);
  if (!handle) return false;
  auto callbacks = static_cast<const service_type_support_callbacks_t *>(handle->data);
  type.name = type_name(callbacks->service_namespace_, callbacks->service_name_);
  type.request = callbacks_of(callbacks->request_members_);
  type.response = callbacks_of(callbacks->response_members_);
  if (support->get_type_hash_func) type.hash = *support->get_type_hash_func(support);
  return type.request && type.response;
}

Bytes serialize(Callbacks callbacks, const void * message) {
  constexpr size_t HEADER = 4;
  auto bytes = std::make_shared<std::vector<uint8_t>>(callbacks->get_serialized_size(message) + HEADER);
  FastBuffer buffer(reinterpret_cast<char *>(bytes->data()), bytes->size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  try {
    cdr.serialize_encapsulation();
    if (callbacks->cdr_serialize(message, cdr)) {
      bytes->resize(cdr.get_serialized_data_length());
      return bytes;
    }
    RMW_SET_ERROR_MSG("the message cannot be serialized");
  } catch (const std::exception & error) {
    RMW_SET_ERROR_MSG_WITH_FORMAT_STRING("the message cannot be serialized: %s", error.what());
  }
  return nullptr;
}

bool deserialize(Callbacks callbacks, const uint8_t * data, size_t size, void * message) {
  FastBuffer buffer(reinterpret_cast<char *>(const_cast<uint8_t *>(data)), size);
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN);
  try {
    cdr.read_encapsulation();
    if (callbacks->cdr_deserialize(cdr, message)) return true;
    RMW_SET_ERROR_MSG("these bytes are not a message of this type");
  } catch (const std::exception & error) {
    RMW_SET_ERROR_MSG_WITH_FORMAT_STRING("these bytes are not a message of this type: %s", error.what());
  }
  return false;
}

}  // namespace rmw_lockstep
