// rcl's functions that end a context, and that ask whether it has ended.
//
// They are where a program's own thread and rclpy's thread for signals race, so a program waits here for the other one,
// wherever the signal has found it: in a callback, in a sleep, in an executor that waits for a condition variable.
#include "lockstep.h"
#include "real.hpp"
#include "signals.hpp"

using namespace lockstep;

namespace {

// librcl is loaded for Python's extension modules alone, so it is not where dlsym(RTLD_NEXT) looks.
void * find(const char * name, const void * caller) {
  Dl_info info;
  void * const object = dladdr(caller, &info) ? dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD) : nullptr;
  void * const found = object ? dlsym(object, name) : nullptr;
  if (object) dlclose(object);
  return found ? found : dlsym(RTLD_NEXT, name);
}

}  // namespace

extern "C" {

// rcl_ret_t rcl_shutdown(rcl_context_t *)
LOCKSTEP_API int rcl_shutdown(void * context) {
  static const auto shutdown = reinterpret_cast<int (*)(void *)>(find("rcl_shutdown", __builtin_return_address(0)));
  signals().settle();
  return shutdown(context);
}

LOCKSTEP_API bool rcl_context_is_valid(const void * context) {
  static const auto is_valid =
    reinterpret_cast<bool (*)(const void *)>(find("rcl_context_is_valid", __builtin_return_address(0)));
  signals().settle();
  return is_valid(context);
}

}  // extern "C"
