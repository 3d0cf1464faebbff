// Quality of service: the policies that a profile results in, and which publisher matches which subscription.
#pragma once

#include <cstdint>
#include <vector>

#include "rmw/types.h"

namespace rmw_lockstep {

constexpr int64_t FOREVER = INT64_MAX;

// Nanoseconds; FOREVER for "infinite" and for "unspecified".
int64_t nanoseconds(const rmw_time_t & time);

// The policies in which a subscription requests more than a publisher offers, the first one first; empty: they match.
std::vector<rmw_qos_policy_kind_t> mismatches(const rmw_qos_profile_t & offered, const rmw_qos_profile_t & requested);

inline bool is_transient_local(const rmw_qos_profile_t & profile) {
  return profile.durability == RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
}

inline bool compatible(const rmw_qos_profile_t & offered, const rmw_qos_profile_t & requested) {
  return mismatches(offered, requested).empty();
}

// Replaces "system default", "best available" and "unspecified" by actual values; `peers` are the profiles of the
// current endpoints at the other end.
void settle(rmw_qos_profile_t & profile, bool of_subscription, const std::vector<rmw_qos_profile_t> & peers);

}  // namespace rmw_lockstep
