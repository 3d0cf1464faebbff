#include "inherited.hpp"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include "lockstep.h"

namespace lockstep {
namespace {

int kept = -1;

// A message of one byte with room for one descriptor: cmsg(3).
struct Passing {
  char byte = '+';
  iovec content{&byte, 1};
  alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))]{};
  msghdr message{};

  Passing() {
    message.msg_iov = &content;
    message.msg_iovlen = 1;
    message.msg_control = room;
    message.msg_controllen = sizeof room;
  }
};

bool send_descriptor(int to, int number) {
  Passing passing;
  cmsghdr * head = CMSG_FIRSTHDR(&passing.message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof number);
  memcpy(CMSG_DATA(head), &number, sizeof number);
  ssize_t sent;
  do sent = sendmsg(to, &passing.message, MSG_NOSIGNAL); while (sent < 0 && errno == EINTR);
  return sent == 1;
}

int receive_descriptor(int from) {
  Passing passing;
  ssize_t got;
  do got = recvmsg(from, &passing.message, MSG_CMSG_CLOEXEC); while (got < 0 && errno == EINTR);
  const cmsghdr * head = got == 1 ? CMSG_FIRSTHDR(&passing.message) : nullptr;
  if (!head || head->cmsg_type != SCM_RIGHTS) {
    if (got >= 0) errno = ECONNREFUSED;
    return -1;
  }
  int number;
  memcpy(&number, CMSG_DATA(head), sizeof number);
  return number;
}

int close_range_without(unsigned first, unsigned last, int flags) {
  const auto middle = static_cast<unsigned>(kept);
  if (kept < 0 || middle < first || middle > last) return syscall(SYS_close_range, first, last, flags);
  if (middle > first && syscall(SYS_close_range, first, middle - 1, flags)) return -1;
  return middle < last ? syscall(SYS_close_range, middle + 1, last, flags) : 0;
}

}  // namespace

int inherited_number(const std::string & path) { return path.rfind("fd:", 0) ? -1 : atoi(path.c_str() + 3); }

int connection_through(int inherited) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) return -1;
  const bool sent = send_descriptor(inherited, ends[1]);
  int fault = errno;
  close(ends[1]);
  const int connection = sent ? receive_descriptor(ends[0]) : -1;
  if (sent) fault = errno;
  close(ends[0]);
  errno = fault;
  return connection;
}

void keep_open(int inherited) { kept = inherited; }

}  // namespace lockstep

extern "C" {

LOCKSTEP_API int close(int number) {
  if (number >= 0 && number == lockstep::kept) return 0;
  return syscall(SYS_close, number);
}

LOCKSTEP_API int close_range(unsigned first, unsigned last, int flags) {
  return lockstep::close_range_without(first, last, flags);
}

LOCKSTEP_API void closefrom(int first) { lockstep::close_range_without(first < 0 ? 0 : first, ~0U, 0); }

}  // extern "C"
