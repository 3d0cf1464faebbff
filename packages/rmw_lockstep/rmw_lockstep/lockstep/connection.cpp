// The socket to the hub, and the thread that listens to it.
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>

#include "bytes.hpp"
#include "core.hpp"
#include "inherited.hpp"
#include "real.hpp"
#include "signals.hpp"

namespace lockstep {
namespace {

constexpr uint32_t VERSION = 3;

// While the process is busy, and no thread would report that it becomes idle, the listener checks at intervals (ns):
// the first one, then twice as long each time, up to the longest.
constexpr int64_t FIRST_LOOK = 500'000, LONGEST_LOOK = 2'000'000;

int open_socket(const std::string & path) {
  if (const int inherited = inherited_number(path); inherited >= 0) {
    keep_open(inherited);
    return connection_through(inherited);
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) { errno = ENAMETOOLONG; return -1; }
  memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int number = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (number < 0) return -1;
  if (::connect(number, reinterpret_cast<sockaddr *>(&address), sizeof address) == 0) return number;
  const int fault = errno;
  close(number);
  errno = fault;
  return -1;
}

// Whether the C library's clock and sleeps are this library's, as they are when it is preloaded.
bool preloaded() { return dlsym(RTLD_DEFAULT, "clock_nanosleep") == reinterpret_cast<void *>(&::clock_nanosleep); }

}  // namespace

int Core::connect(const std::string & path) {
  if (connected_) return EALREADY;
  if (!threads_.count()) return ENOSYS;  // without /proc/self/task no other thread would be seen
  socket_ = open_socket(path);
  if (socket_ < 0) return errno;
  path_ = path;
  const bool takes_time = preloaded();
  std::vector<uint8_t> hello;
  Writer(hello, 'H').put<uint32_t>(VERSION).put<uint32_t>(getpid()).put<uint32_t>(getppid()).put<uint8_t>(takes_time);
  connected_ = true;
  send(hello.data(), hello.size());
  uint32_t size = 0;
  while (connected_ && !front(size)) receive();
  if (!connected_) return ECONNRESET;
  Reader welcome(front(size) + 1, size - 1);
  const auto version = welcome.get<uint32_t>();
  process_ = welcome.get<uint32_t>();
  const auto now = welcome.get<int64_t>();
  epoch_ = welcome.get<int64_t>();
  if (version != VERSION || front(size)[0] != 'W' || !welcome.ok()) { lost(); return EPROTO; }
  pop();
  now_ = takes_time ? now : real::now(CLOCK_MONOTONIC);
  virtual_ = takes_time;
  poke_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  // Signals are for the program's threads.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, 256 * 1024);
  pthread_t thread;
  listener_ = 0;
  const int fault = pthread_create(&thread, &attributes, &Core::listener_thread, this);
  pthread_attr_destroy(&attributes);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (fault) { lost(); return fault; }
  while (!__atomic_load_n(&listener_, __ATOMIC_ACQUIRE)) sched_yield();
  return 0;
}

void * Core::listener_thread(void * core) {
  prctl(PR_SET_NAME, "lockstep");
  reads_clock_freely = true;
  static_cast<Core *>(core)->listen_to_hub();
  return nullptr;
}

void Core::listen_to_hub() {
  __atomic_store_n(&listener_, thread_number(), __ATOMIC_RELEASE);
  int64_t look = FIRST_LOOK;
  lock();
  while (connected_) {
    step();
    if (!later_.empty()) { unlock(); lock(); continue; }
    const bool recheck = recheck_;
    look = recheck ? std::min(look * 2, LONGEST_LOOK) : FIRST_LOOK;
    listener_sleeps_ = !recheck;
    const int socket = socket_, wakes = poke_;
    pthread_mutex_unlock(&mutex_);
    pollfd files[2] = {{socket, POLLIN, 0}, {wakes, POLLIN, 0}};
    const timespec timeout = real::as_timespec(look);
    real::ppoll()(files, 2, recheck ? &timeout : nullptr, nullptr);
    lock();
    listener_sleeps_ = false;
    if (files[1].revents) { uint64_t count; (void)!read(wakes, &count, sizeof count); }
    if (files[0].revents) { receive(); look = FIRST_LOOK; }
  }
  pthread_mutex_unlock(&mutex_);
}

void Core::poke() {
  if (!listener_sleeps_) return;
  listener_sleeps_ = false;
  const uint64_t one = 1;
  (void)!write(poke_, &one, sizeof one);
}

void Core::receive() {
  if (in_at_ == in_.size()) { in_.clear(); in_at_ = 0; }
  else if (in_at_ > 1 << 20) { in_.erase(in_.begin(), in_.begin() + static_cast<long>(in_at_)); in_at_ = 0; }
  static uint8_t piece[65536];
  ssize_t got;
  do got = recv(socket_, piece, sizeof piece, 0); while (got < 0 && errno == EINTR);
  if (got > 0) in_.insert(in_.end(), piece, piece + got);
  else lost();
}

// The hub is gone: no frame will arrive, nobody waits for this process, and its time is the computer's from now on.
void Core::lost() {
  connected_ = false;
  virtual_ = false;
  if (socket_ >= 0) shutdown(socket_, SHUT_RDWR);
  for (Sleeper * sleeper : sleepers_) wake(*sleeper, false);
  signals().give_up();
}

const uint8_t * Core::front(uint32_t & size) const {
  if (in_.size() - in_at_ < sizeof size) return nullptr;
  memcpy(&size, &in_[in_at_], sizeof size);
  return size && in_.size() - in_at_ - sizeof size >= size ? &in_[in_at_ + sizeof size] : nullptr;
}

void Core::pop() {
  uint32_t size;
  if (!front(size)) return;
  in_at_ += sizeof size + size;
  ++handled_;
  changed_ = true;
}

void Core::send(const uint8_t * frame, size_t size) {
  size_t done = 0;
  while (connected_ && done < size) {
    const ssize_t sent = ::send(socket_, frame + done, size - done, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) { lost(); return; }
    done += static_cast<size_t>(sent);
  }
}

}  // namespace lockstep
