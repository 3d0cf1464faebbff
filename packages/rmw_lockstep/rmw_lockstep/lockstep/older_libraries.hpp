// Included first in every file that `build.py` compiles: on x86_64 the result then runs wherever PyPI's ROS 2 does,
// with glibc 2.28 and GCC 8's C++ library, whatever the versions on the machine that compiles it.
#pragma once

#include <cstddef>

// Keep the code of std::string in these libraries: newer versions call functions that older C++ libraries lack.
#undef _GLIBCXX_EXTERN_TEMPLATE
#define _GLIBCXX_EXTERN_TEMPLATE 0

#if defined(__x86_64__) && defined(__linux__)

// glibc 2.34 gave these a new version when it moved them out of libpthread and libdl. The old one is the same function.
#define LOCKSTEP_OLDER(function) __asm__(".symver " #function ", " #function "@GLIBC_2.2.5")
LOCKSTEP_OLDER(dladdr);
LOCKSTEP_OLDER(dlclose);
LOCKSTEP_OLDER(dlopen);
LOCKSTEP_OLDER(dlsym);
LOCKSTEP_OLDER(dlvsym);
LOCKSTEP_OLDER(pthread_attr_setstacksize);
LOCKSTEP_OLDER(pthread_create);
LOCKSTEP_OLDER(pthread_sigmask);
LOCKSTEP_OLDER(sem_destroy);
LOCKSTEP_OLDER(sem_getvalue);
LOCKSTEP_OLDER(sem_init);
#undef LOCKSTEP_OLDER

// C23's functions, from glibc 2.38 on, differ only in how they read binary numbers. GCC's static C++ library calls two.
__asm__(".symver __isoc23_sscanf, __isoc99_sscanf@GLIBC_2.7");
#define LOCKSTEP_BEFORE_C23(type, function)                                                                  \
  extern "C" type lockstep_##function(const char *, char **, int);                                           \
  __asm__(".symver lockstep_" #function ", " #function "@GLIBC_2.2.5");                                      \
  extern "C" __attribute__((weak, visibility("hidden"))) type __isoc23_##function(const char * text, char ** end, int base) { \
    return lockstep_##function(text, end, base);                                                             \
  }
LOCKSTEP_BEFORE_C23(long, strtol)
LOCKSTEP_BEFORE_C23(unsigned long, strtoul)
#undef LOCKSTEP_BEFORE_C23

// C++ reads this variable (glibc 2.32) and uses atomic operations unless it is set. They are always right.
extern "C" __attribute__((weak, visibility("hidden"))) char __libc_single_threaded = 0;

#endif
