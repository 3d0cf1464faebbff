// Where a process connects: when its program starts, after a fork, or when lockstep_connect is called.
#include <stdlib.h>
#include <sys/wait.h>

#include <errno.h>

#include "core.hpp"
#include "real.hpp"

using namespace lockstep;

namespace {

pid_t fork_and_tell(bool connect_again) {
  core().lock();
  const pid_t child = real::fork()();
  if (child == 0) {
    core().reset_in_child(connect_again);
    return 0;
  }
  core().forked(child);
  core().unlock();
  return child;
}

template<typename Spawn>
int spawn_and_tell(Spawn spawn, pid_t * pid) {
  pid_t child = 0;
  core().lock();
  const int fault = spawn(&child);
  if (!fault) core().forked(child);
  core().unlock();
  if (pid) *pid = child;
  return fault;
}

}  // namespace

extern "C" {

LOCKSTEP_API pid_t fork() { return fork_and_tell(true); }

// The child of a vfork is about to become another program, which connects by itself. It is a copy of its parent's
// memory, and not its parent's memory, which is allowed (vfork, POSIX.1-2001).
LOCKSTEP_API pid_t vfork() { return fork_and_tell(false); }

LOCKSTEP_API int posix_spawn(
    pid_t * pid, const char * path, const posix_spawn_file_actions_t * actions, const posix_spawnattr_t * attributes,
    char * const arguments[], char * const environment[]) {
  return spawn_and_tell([&](pid_t * child) {
    return real::posix_spawn()(child, path, actions, attributes, arguments, environment);
  }, pid);
}

LOCKSTEP_API int posix_spawnp(
    pid_t * pid, const char * file, const posix_spawn_file_actions_t * actions, const posix_spawnattr_t * attributes,
    char * const arguments[], char * const environment[]) {
  return spawn_and_tell([&](pid_t * child) {
    return real::posix_spawnp()(child, file, actions, attributes, arguments, environment);
  }, pid);
}

// Like system(3), but with the fork above.
LOCKSTEP_API int system(const char * command) {
  if (!command) return 1;
  struct sigaction ignore{}, interrupt, quit;
  ignore.sa_handler = SIG_IGN;
  sigset_t block, before;
  sigemptyset(&block);
  sigaddset(&block, SIGCHLD);
  sigaction(SIGINT, &ignore, &interrupt);
  sigaction(SIGQUIT, &ignore, &quit);
  pthread_sigmask(SIG_BLOCK, &block, &before);
  const pid_t child = ::vfork();
  if (child == 0) {
    sigaction(SIGINT, &interrupt, nullptr);
    sigaction(SIGQUIT, &quit, nullptr);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    execl("/bin/sh", "sh", "-c", command, nullptr);
    _exit(127);
  }
  int status = -1;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  sigaction(SIGINT, &interrupt, nullptr);
  sigaction(SIGQUIT, &quit, nullptr);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return status;
}

LOCKSTEP_API int lockstep_connect(const char * path) { return core().connect(path); }

}  // extern "C"

namespace {

// Looked up before any other thread runs. Later, a thread that holds a lock of its own (LTTng's, which rclpy starts)
// would wait here for the loader, while the loader's constructors wait for that lock.
void find_real_functions() {
  using namespace lockstep::real;
  clock_gettime(), gettimeofday(), time(), clock_nanosleep();
  sem_trywait(), sem_wait(), sem_timedwait(), clocked_sem_wait();
  pthread_cond_wait(), pthread_cond_timedwait(), pthread_cond_broadcast(), pthread_cond_clockwait();
  poll(), ppoll(), select(), pselect(), epoll_wait(), epoll_pwait();
  lockstep::real::fork(), posix_spawn(), posix_spawnp();
}

__attribute__((constructor)) void begin() {
  find_real_functions();
  if (const char * path = getenv("RMW_LOCKSTEP_SOCKET")) core().connect(path);
}

}  // namespace
