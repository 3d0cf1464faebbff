// Whether a topic or a service may have its name.
#pragma once

#include "rmw/error_handling.h"
#include "rmw/types.h"
#include "rmw/validate_full_topic_name.h"

namespace rmw_lockstep {

// `what` is "topic" or "service". False, with rmw's error set, if the name is not valid.
inline bool valid_name(const char * what, const char * name, const rmw_qos_profile_t & qos) {
  int result = 0;
  if (!*name) {
    RMW_SET_ERROR_MSG_WITH_FORMAT_STRING("the %s's name is empty", what);
    return false;
  }
  if (qos.avoid_ros_namespace_conventions) return true;
  if (rmw_validate_full_topic_name(name, &result, nullptr) != RMW_RET_OK) return false;
  if (result == RMW_TOPIC_VALID) return true;
  RMW_SET_ERROR_MSG_WITH_FORMAT_STRING(
      "invalid %s name: %s", what, rmw_full_topic_name_validation_result_string(result));
  return false;
}

}  // namespace rmw_lockstep
