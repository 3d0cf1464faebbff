// The checks with which rmw's functions begin.
#pragma once

#include <string.h>

#include "rmw/allocators.h"
#include "rmw/error_handling.h"
#include "rmw/ret_types.h"
#include "types.hpp"

#define RMW_LOCKSTEP_API extern "C" __attribute__((visibility("default")))

#define REQUIRE(pointer)                                                  \
  do {                                                                    \
    if (!(pointer)) {                                                     \
      RMW_SET_ERROR_MSG(#pointer " is null");                             \
      return RMW_RET_INVALID_ARGUMENT;                                    \
    }                                                                     \
  } while (0)

#define REQUIRE_OR_NULL(pointer)                                          \
  do {                                                                    \
    if (!(pointer)) {                                                     \
      RMW_SET_ERROR_MSG(#pointer " is null");                             \
      return nullptr;                                                     \
    }                                                                     \
  } while (0)

#define REQUIRE_OURS(handle)                                              \
  do {                                                                    \
    REQUIRE(handle);                                                      \
    if (!rmw_lockstep::is_ours((handle)->implementation_identifier)) {    \
      RMW_SET_ERROR_MSG(#handle " is of another middleware");             \
      return RMW_RET_INCORRECT_RMW_IMPLEMENTATION;                        \
    }                                                                     \
  } while (0)

#define UNSUPPORTED(what)                                                 \
  do {                                                                    \
    RMW_SET_ERROR_MSG("rmw_lockstep_cpp does not support " what);         \
    return RMW_RET_UNSUPPORTED;                                           \
  } while (0)

namespace rmw_lockstep {

inline bool is_ours(const char * identifier) { return identifier && strcmp(identifier, IDENTIFIER) == 0; }

inline const char * copy_text(const char * text) {
  auto copy = static_cast<char *>(rmw_allocate(strlen(text) + 1));
  return copy ? strcpy(copy, text) : nullptr;
}

inline void free_text(const char * text) { rmw_free(const_cast<char *>(text)); }

}  // namespace rmw_lockstep
