// Messages: their type support, their names, and their bytes (CDR, as every DDS middleware writes them).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rmw/types.h"
#include "rosidl_runtime_c/message_type_support_struct.h"
#include "rosidl_runtime_c/service_type_support_struct.h"
#include "rosidl_typesupport_fastrtps_cpp/message_type_support.h"
#include "rosidl_typesupport_fastrtps_cpp/service_type_support.h"

namespace rmw_lockstep {

inline const char * const IDENTIFIER = "rmw_lockstep_cpp";

using Bytes = std::shared_ptr<const std::vector<uint8_t>>;
using Callbacks = const message_type_support_callbacks_t *;

struct MessageType {
  Callbacks callbacks = nullptr;
  std::string name;  // such as sensor_msgs/msg/JointState
  rosidl_type_hash_t hash{};
};

struct ServiceType {
  Callbacks request = nullptr, response = nullptr;
  std::string name;
  rosidl_type_hash_t hash{};
};

// False, with rmw's error set, if the generated code for rosidl_typesupport_fastrtps is missing.
bool find_type(const rosidl_message_type_support_t * support, MessageType & type);
bool find_type(const rosidl_service_type_support_t * support, ServiceType & type);

// The bytes of a message with their encapsulation header; null, with rmw's error set, if it can't be serialized.
Bytes serialize(Callbacks callbacks, const void * message);
bool deserialize(Callbacks callbacks, const uint8_t * data, size_t size, void * message);

}  // namespace rmw_lockstep
