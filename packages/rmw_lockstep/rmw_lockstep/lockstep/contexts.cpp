// rcl's functions that end a context, and that ask whether it has ended.
//
// This is where the program's own thread and rclpy's signal thread race. So the program waits here for the signal
// thread, whatever the signal interrupted: a callback, a sleep, or an executor that waits for a condition variable.
#include "lockstep.h"
#include "real.hpp"
#include "signals.hpp"

using namespace lockstep;

namespace {

// Python loads librcl for its extension modules only (RTLD_LOCAL), so dlsym(RTLD_NEXT) does not find it.
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
