// Events of publishers and subscriptions: deadlines, liveliness, matches, and what does not match.
#include "checks.hpp"
#include "graph.hpp"
#include "rmw/event.h"
#include "rmw/rmw.h"

using namespace rmw_lockstep;

namespace {

rmw_ret_t init_event(rmw_event_t * event, const char * identifier, void * endpoint, rmw_event_type_t type) {
  REQUIRE(event);
  if (!is_ours(identifier)) {
    RMW_SET_ERROR_MSG("the endpoint is of another middleware");
    return RMW_RET_INCORRECT_RMW_IMPLEMENTATION;
  }
  if (!rmw_event_type_is_supported(type)) UNSUPPORTED("this type of event");
  event->implementation_identifier = IDENTIFIER;
  event->data = endpoint;
  event->event_type = type;
  return RMW_RET_OK;
}

template<typename Status>
void hand_over(Status & status, void * out) {
  *static_cast<Status *>(out) = status;
}

template<typename Status>
void hand_over_total(Status & status, void * out) {
  hand_over(status, out);
  status.total_count_change = 0;
}

void hand_over(Events & events, rmw_event_type_t type, void * out) {
  switch (type) {
    case RMW_EVENT_PUBLICATION_MATCHED:
    case RMW_EVENT_SUBSCRIPTION_MATCHED:
      hand_over_total(events.matched, out);
      events.matched.current_count_change = 0;
      break;
    case RMW_EVENT_LIVELINESS_CHANGED:
      hand_over(events.liveliness_changed, out);
      events.liveliness_changed.alive_count_change = events.liveliness_changed.not_alive_count_change = 0;
      break;
    case RMW_EVENT_REQUESTED_QOS_INCOMPATIBLE:
    case RMW_EVENT_OFFERED_QOS_INCOMPATIBLE: hand_over_total(events.incompatible_qos, out); break;
    case RMW_EVENT_SUBSCRIPTION_INCOMPATIBLE_TYPE:
    case RMW_EVENT_PUBLISHER_INCOMPATIBLE_TYPE: hand_over_total(events.incompatible_type, out); break;
    case RMW_EVENT_REQUESTED_DEADLINE_MISSED: hand_over_total(events.requested_deadline, out); break;
    case RMW_EVENT_OFFERED_DEADLINE_MISSED: hand_over_total(events.offered_deadline, out); break;
    case RMW_EVENT_LIVELINESS_LOST: hand_over_total(events.liveliness_lost, out); break;
    case RMW_EVENT_MESSAGE_LOST: hand_over_total(events.message_lost, out); break;
    case RMW_EVENT_INVALID: break;
  }
}

Endpoint & of(const rmw_event_t * event) { return *static_cast<Endpoint *>(event->data); }

}  // namespace

RMW_LOCKSTEP_API bool rmw_event_type_is_supported(rmw_event_type_t type) { return type < RMW_EVENT_INVALID; }

RMW_LOCKSTEP_API rmw_ret_t rmw_publisher_event_init(
    rmw_event_t * event, const rmw_publisher_t * publisher, rmw_event_type_t type) {
  REQUIRE(publisher);
  return init_event(event, publisher->implementation_identifier, publisher->data, type);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_subscription_event_init(
    rmw_event_t * event, const rmw_subscription_t * subscription, rmw_event_type_t type) {
  REQUIRE(subscription);
  return init_event(event, subscription->implementation_identifier, subscription->data, type);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_take_event(const rmw_event_t * event, void * info, bool * taken) {
  REQUIRE_OURS(event);
  REQUIRE(info);
  REQUIRE(taken);
  Lock lock;
  Events & events = of(event).events;
  events.pending[event->event_type] = false;
  hand_over(events, event->event_type, info);  // even if nothing has happened, as Fast DDS does
  *taken = true;
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_event_set_callback(rmw_event_t * event, rmw_event_callback_t callback, const void * data) {
  REQUIRE_OURS(event);
  Lock lock;
  of(event).events.listeners[event->event_type].set(callback, data);
  return RMW_RET_OK;
}
