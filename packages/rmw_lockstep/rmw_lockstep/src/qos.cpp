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
  if (is_transient_local(requested) && !is_transient_local(offered)) found.push_back(RMW_QOS_POLICY_DURABILITY);
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
    profile.durability = of_subscription && !every(peers, is_transient_local) ? RMW_QOS_POLICY_DURABILITY_VOLATILE
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

bool undecided(rmw_qos_reliability_policy_t policy) {
  return policy == RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT || policy == RMW_QOS_POLICY_RELIABILITY_UNKNOWN;
}

bool undecided(rmw_qos_durability_policy_t policy) {
  return policy == RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT || policy == RMW_QOS_POLICY_DURABILITY_UNKNOWN;
}

// The policies that may mismatch, since an end's defaults cannot be known before it exists. In that case, both
// profiles are changed to the default that matches.
std::vector<rmw_qos_policy_kind_t> settle_undecided(rmw_qos_profile_t & offered, rmw_qos_profile_t & requested) {
  std::vector<rmw_qos_policy_kind_t> found;
  const bool reliability = (undecided(offered.reliability) && reliable(requested)) ||
                           (undecided(requested.reliability) && !reliable(offered));
  const bool durability = (undecided(offered.durability) && is_transient_local(requested)) ||
                          (undecided(requested.durability) && !is_transient_local(offered));
  if (durability) found.push_back(RMW_QOS_POLICY_DURABILITY);
  if (reliability) found.push_back(RMW_QOS_POLICY_RELIABILITY);
  if (undecided(offered.reliability)) offered.reliability = RMW_QOS_POLICY_RELIABILITY_RELIABLE;
  if (undecided(offered.durability)) offered.durability = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
  return found;
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
  rmw_qos_profile_t offer = offered, request = requested;
  const auto possible = settle_undecided(offer, request);
  const auto certain = mismatches(offer, request);
  *compatibility = !certain.empty()   ? RMW_QOS_COMPATIBILITY_ERROR
                   : !possible.empty() ? RMW_QOS_COMPATIBILITY_WARNING
                                       : RMW_QOS_COMPATIBILITY_OK;
  if (!reason || !size) return RMW_RET_OK;
  for (const auto kind : certain)
    append(reason, size, std::string("ERROR: the publisher offers less than the subscription requests: ") +
                             rmw_qos_policy_kind_to_str(kind) + ";");
  for (const auto kind : possible)
    append(reason, size, std::string("WARNING: it depends on a default whether this matches: ") +
                             rmw_qos_policy_kind_to_str(kind) + ";");
  return RMW_RET_OK;
}
