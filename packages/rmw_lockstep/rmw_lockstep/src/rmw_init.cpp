// Contexts.
#include "checks.hpp"
#include "graph.hpp"
#include "rcutils/strdup.h"
#include "rmw/discovery_options.h"
#include "rmw/domain_id.h"
#include "rmw/features.h"
#include "rmw/init.h"
#include "rmw/init_options.h"
#include "rmw/rmw.h"

using namespace rmw_lockstep;

struct rmw_context_impl_s { bool is_shut_down = false; };

RMW_LOCKSTEP_API const char * rmw_get_implementation_identifier() { return IDENTIFIER; }
RMW_LOCKSTEP_API const char * rmw_get_serialization_format() { return "cdr"; }
RMW_LOCKSTEP_API rmw_ret_t rmw_set_log_severity(rmw_log_severity_t) { return RMW_RET_OK; }
RMW_LOCKSTEP_API bool rmw_feature_supported(rmw_feature_t) { return false; }

RMW_LOCKSTEP_API rmw_ret_t rmw_init_options_init(rmw_init_options_t * options, rcutils_allocator_t allocator) {
  REQUIRE(options);
  if (!rcutils_allocator_is_valid(&allocator)) {
    RMW_SET_ERROR_MSG("allocator is not valid");
    return RMW_RET_INVALID_ARGUMENT;
  }
  if (options->implementation_identifier) {
    RMW_SET_ERROR_MSG("the options have been initialized already");
    return RMW_RET_INVALID_ARGUMENT;
  }
  *options = rmw_get_zero_initialized_init_options();
  options->implementation_identifier = IDENTIFIER;
  options->allocator = allocator;
  options->domain_id = RMW_DEFAULT_DOMAIN_ID;
  options->security_options = rmw_get_default_security_options();
  options->localhost_only = RMW_LOCALHOST_ONLY_DEFAULT;
  return rmw_discovery_options_init(&options->discovery_options, 0, &allocator);
}

RMW_LOCKSTEP_API rmw_ret_t rmw_init_options_copy(const rmw_init_options_t * from, rmw_init_options_t * to) {
  REQUIRE(from);
  REQUIRE(to);
  if (!from->implementation_identifier || to->implementation_identifier) {
    RMW_SET_ERROR_MSG("the source is not initialized, or the destination is");
    return RMW_RET_INVALID_ARGUMENT;
  }
  REQUIRE_OURS(from);
  rcutils_allocator_t allocator = from->allocator;
  rmw_init_options_t copy = *from;
  copy.enclave = from->enclave ? rcutils_strdup(from->enclave, allocator) : nullptr;
  copy.security_options = rmw_get_zero_initialized_security_options();
  copy.discovery_options = rmw_get_zero_initialized_discovery_options();
  rmw_ret_t result = rmw_security_options_copy(&from->security_options, &allocator, &copy.security_options);
  if (result == RMW_RET_OK)
    result = rmw_discovery_options_copy(&from->discovery_options, &allocator, &copy.discovery_options);
  if (result == RMW_RET_OK) *to = copy;
  return result;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_init_options_fini(rmw_init_options_t * options) {
  REQUIRE(options);
  if (!options->implementation_identifier) {
    RMW_SET_ERROR_MSG("the options are not initialized");
    return RMW_RET_INVALID_ARGUMENT;
  }
  REQUIRE_OURS(options);
  rcutils_allocator_t allocator = options->allocator;
  allocator.deallocate(options->enclave, allocator.state);
  (void)rmw_security_options_fini(&options->security_options, &allocator);
  const rmw_ret_t result = rmw_discovery_options_fini(&options->discovery_options);
  *options = rmw_get_zero_initialized_init_options();
  return result;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_init(const rmw_init_options_t * options, rmw_context_t * context) {
  REQUIRE(options);
  REQUIRE(context);
  if (!options->implementation_identifier || !options->enclave || context->implementation_identifier) {
    RMW_SET_ERROR_MSG("the options have no enclave or are not initialized, or the context is");
    return RMW_RET_INVALID_ARGUMENT;
  }
  REQUIRE_OURS(options);
  rmw_init_options_t copy = rmw_get_zero_initialized_init_options();
  const rmw_ret_t result = rmw_init_options_copy(options, &copy);
  if (result != RMW_RET_OK) return result;
  context->instance_id = options->instance_id;
  context->implementation_identifier = IDENTIFIER;
  context->actual_domain_id = options->domain_id == RMW_DEFAULT_DOMAIN_ID ? 0 : options->domain_id;
  context->options = copy;
  context->impl = new rmw_context_impl_s;
  Lock lock;
  graph().join();
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_shutdown(rmw_context_t * context) {
  REQUIRE(context);
  REQUIRE(context->impl);
  REQUIRE_OURS(context);
  context->impl->is_shut_down = true;
  return RMW_RET_OK;
}

RMW_LOCKSTEP_API rmw_ret_t rmw_context_fini(rmw_context_t * context) {
  REQUIRE(context);
  REQUIRE(context->impl);
  REQUIRE_OURS(context);
  if (!context->impl->is_shut_down) {
    RMW_SET_ERROR_MSG("the context has not been shut down");
    return RMW_RET_INVALID_ARGUMENT;
  }
  delete context->impl;
  const rmw_ret_t result = rmw_init_options_fini(&context->options);
  *context = rmw_get_zero_initialized_context();
  return result;
}
