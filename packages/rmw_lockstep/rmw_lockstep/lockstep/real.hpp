// The C library's own functions, below those of the same names that this library puts in their place.
#pragma once

#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <spawn.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <initializer_list>

namespace lockstep::real {

// `version` is looked up first: without it, dlsym may find a condition variable of 2002 (GLIBC_2.2.5 on x86_64).
// If this library is not preloaded, it comes after the C library, which is then the first to have the name.
inline void * find(const char * name, const char * version = nullptr) {
  for (void * where : {RTLD_NEXT, RTLD_DEFAULT}) {
    if (void * found = version ? dlvsym(where, name, version) : nullptr) return found;
    if (void * found = dlsym(where, name)) return found;
  }
  return nullptr;
}

#define LOCKSTEP_REAL(name, version)                                     \
  inline decltype(&::name) name() {                                      \
    static auto function = reinterpret_cast<decltype(&::name)>(find(#name, version)); \
    return function;                                                     \
  }

LOCKSTEP_REAL(clock_gettime, nullptr)
LOCKSTEP_REAL(gettimeofday, nullptr)
LOCKSTEP_REAL(time, nullptr)
LOCKSTEP_REAL(clock_nanosleep, nullptr)
LOCKSTEP_REAL(sem_trywait, nullptr)
LOCKSTEP_REAL(sem_wait, nullptr)
LOCKSTEP_REAL(sem_post, nullptr)
LOCKSTEP_REAL(sem_timedwait, nullptr)
LOCKSTEP_REAL(pthread_cond_wait, "GLIBC_2.3.2")
LOCKSTEP_REAL(pthread_cond_timedwait, "GLIBC_2.3.2")
LOCKSTEP_REAL(pthread_cond_broadcast, "GLIBC_2.3.2")
LOCKSTEP_REAL(poll, nullptr)
LOCKSTEP_REAL(ppoll, nullptr)
LOCKSTEP_REAL(select, nullptr)
LOCKSTEP_REAL(pselect, nullptr)
LOCKSTEP_REAL(epoll_wait, nullptr)
LOCKSTEP_REAL(epoll_pwait, nullptr)
LOCKSTEP_REAL(fork, nullptr)
LOCKSTEP_REAL(posix_spawn, "GLIBC_2.15")
LOCKSTEP_REAL(posix_spawnp, "GLIBC_2.15")

#undef LOCKSTEP_REAL

// glibc 2.30 and newer.
using cond_clockwait = int (*)(pthread_cond_t *, pthread_mutex_t *, clockid_t, const timespec *);
using sem_clockwait = int (*)(sem_t *, clockid_t, const timespec *);
inline cond_clockwait pthread_cond_clockwait() {
  static auto function = reinterpret_cast<cond_clockwait>(find("pthread_cond_clockwait"));
  return function;
}
inline sem_clockwait clocked_sem_wait() {
  static auto function = reinterpret_cast<sem_clockwait>(find("sem_clockwait"));
  return function;
}

inline int64_t nanoseconds(const timespec & t) { return t.tv_sec * 1'000'000'000LL + t.tv_nsec; }
inline timespec as_timespec(int64_t ns) { return {ns / 1'000'000'000LL, static_cast<long>(ns % 1'000'000'000LL)}; }
inline int64_t now(clockid_t clock) {
  timespec t;
  clock_gettime()(clock, &t);
  return nanoseconds(t);
}

}  // namespace lockstep::real
