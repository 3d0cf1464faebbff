#include "qos.hpp"

#include <stdio.h>

#include <algorithm>
#include <string>

#include "rmw/error_handling.h"
#include "rmw/qos_string_conversions.h"
#include "rmw/rmw.h"
#include "rmw/time.h"

namespace rmw_lockstep {
namespace {

bool every(const std::vector<rmw_qos_profile_t> & peers, bool (*test)(const rmw_qos_profile_t &)) {
  return std::all_of(peers.begin(), peers.end(), test);
}

bool reliable(const rmw_qos_profile_t & profile) {
  return profile.reliability == RMW_QOS_POLICY_RELIABILITY_RELIABLE;
}

bool lasting(const rmw_qos_profile_t & profile) {
  return profile.durability == RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
}

void settle_time(rmw_time_t & time) {
  const rmw_time_t infinite = RMW_DURATION_INFINITE;
  if (nanoseconds(time) == FOREVER) time = infinite;
}

}  // namespace

int64_t nanoseconds(const rmw_time_t & time) {
  if (!time.sec && !time.nsec) return FOREVER;
  const auto total = static_cast<int64_t>(rmw_time_total_nsec(time));
  return total >= FOREVER - 1 ? FOREVER : total;
}

std::vector<rmw_qos_policy_kind_t> mismatches(const rmw_qos_profile_t & offered, const rmw_qos_profile_t & requested) {
  std::vector<rmw_qos_policy_kind_t> found;
  if (lasting(requested) && !lasting(offered)) found.push_back(RMW_QOS_POLICY_DURABILITY);
  if (nanoseconds(offered.deadline) > nanoseconds(requested.deadline)) found.push_back(RMW_QOS_POLICY_DEADLINE);
  const bool by_hand = requested.liveliness == RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC;
  if ((by_hand && offered.liveliness != requested.liveliness) ||
      nanoseconds(offered.liveliness_lease_duration) > nanoseconds(requested.liveliness_lease_duration))
    found.push_back(RMW_QOS_POLICY_LIVELINESS);
  if (reliable(requested) && !reliable(offered)) found.push_back(RMW_QOS_POLICY_RELIABILITY);
  return found;
}

void settle(rmw_qos_profile_t & profile, bool of_subscription, const std::vector<rmw_qos_profile_t> & peers) {
  if (profile.history == RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT) profile.history = RMW_QOS_POLICY_HISTORY_KEEP_LAST;
  if (profile.history == RMW_QOS_POLICY_HISTORY_KEEP_LAST) profile.depth = std::max<size_t>(profile.depth, 1);
  if (profile.reliability == RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT)
    profile.reliability = of_subscription ? RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT : RMW_QOS_POLICY_RELIABILITY_RELIABLE;
  if (profile.reliability == RMW_QOS_POLICY_RELIABILITY_BEST_AVAILABLE)
    profile.reliability = of_subscription && !every(peers, reliable) ? RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT
                                                                     : RMW_QOS_POLICY_RELIABILITY_RELIABLE;
  if (profile.durability == RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT)
    profile.durability = RMW_QOS_POLICY_DURABILITY_VOLATILE;
  if (profile.durability == RMW_QOS_POLICY_DURABILITY_BEST_AVAILABLE)
    profile.durability = of_subscription && !every(peers, lasting) ? RMW_QOS_POLICY_DURABILITY_VOLATILE
                                                                   : RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
  if (profile.liveliness != RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC)
    profile.liveliness = RMW_QOS_POLICY_LIVELINESS_AUTOMATIC;
  for (rmw_time_t * time : {&profile.deadline, &profile.lifespan, &profile.liveliness_lease_duration}) settle_time(*time);
}

}  // namespace rmw_lockstep

using namespace rmw_lockstep;

namespace {

void append(char * reason, size_t size, const std::string & text) {
  const std::string all = std::string(reason) + text;
  snprintf(reason, size, "%s", all.c_str());
}

bool unknown(int policy, int unknown_value) { return policy == unknown_value; }

// Whether something is not settled yet, so that nobody can tell what it will come to.
bool undecided(const rmw_qos_profile_t & offered, const rmw_qos_profile_t & requested) {
  const bool reliability = (offered.reliability == RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT ||
                            unknown(offered.reliability, RMW_QOS_POLICY_RELIABILITY_UNKNOWN)) &&
                           requested.reliability == RMW_QOS_POLICY_RELIABILITY_RELIABLE;
  const bool durability = (offered.durability == RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT ||
                           unknown(offered.durability, RMW_QOS_POLICY_DURABILITY_UNKNOWN)) &&
                          requested.durability == RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
  return reliability || durability;
}

}  // namespace

extern "C" RMW_PUBLIC rmw_ret_t rmw_qos_profile_check_compatible(
    const rmw_qos_profile_t offered, const rmw_qos_profile_t requested, rmw_qos_compatibility_type_t * compatibility,
    char * reason, size_t size) {
  if (!compatibility || (size && !reason)) {
    RMW_SET_ERROR_MSG("compatibility or reason is null");
    return RMW_RET_INVALID_ARGUMENT;
  }
  if (reason && size) reason[0] = 0;
  const auto found = mismatches(offered, requested);
  *compatibility = RMW_QOS_COMPATIBILITY_OK;
  if (found.empty() && !undecided(offered, requested)) return RMW_RET_OK;
  const bool error = !found.empty();
  *compatibility = error ? RMW_QOS_COMPATIBILITY_ERROR : RMW_QOS_COMPATIBILITY_WARNING;
  if (reason && size) {
    append(reason, size, error ? "" : "WARNING: what the publisher offers depends on its default;");
    for (const auto kind : found)
      append(reason, size, std::string("ERROR: the publisher offers less than the subscription requests: ") +
                               rmw_qos_policy_kind_to_str(kind) + ";");
  }
  return RMW_RET_OK;
}
