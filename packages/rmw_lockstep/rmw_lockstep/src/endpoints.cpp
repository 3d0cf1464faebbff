#include "endpoints.hpp"

#include <string.h>

#include <utility>

#include "../lockstep/lockstep.h"

namespace rmw_lockstep {
namespace {

constexpr char MARK[] = "lockstep";
constexpr size_t MARK_SIZE = sizeof MARK - 1;
static_assert(MARK_SIZE + sizeof(uint64_t) == RMW_GID_STORAGE_SIZE, "a gid has 16 bytes");

}  // namespace

// Listeners may call this middleware again, so they are called once the lock is released.
void Listener::tell() {
  if (function) lockstep_call_later(function, data, 1);
  else ++unheard;
}

void Listener::set(rmw_event_callback_t new_function, const void * new_data) {
  function = new_function;
  data = new_data;
  if (function && unheard) lockstep_call_later(function, data, std::exchange(unheard, 0));
}

void Events::raise(rmw_event_type_t type) {
  pending[type] = true;
  listeners[type].tell();
}

void write_gid(uint64_t id, uint8_t * gid) {
  memcpy(gid, MARK, MARK_SIZE);
  memcpy(gid + MARK_SIZE, &id, sizeof id);
}

uint64_t id_of(const uint8_t * gid) {
  uint64_t id;
  memcpy(&id, gid + MARK_SIZE, sizeof id);
  return id;
}

}  // namespace rmw_lockstep
