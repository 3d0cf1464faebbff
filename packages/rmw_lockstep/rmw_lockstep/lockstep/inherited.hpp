// How a process gets its connection where it may make no Unix sockets of its own: by an inherited one (PROTOCOL.md).
#pragma once

#include <string>

namespace lockstep {

// The number in "fd:NUMBER"; -1 for a path.
int inherited_number(const std::string & path);

// A connection of its own for this process, from the hub at the other end of the inherited socket; -1 and errno.
int connection_through(int inherited);

// From now on, close() and its kin leave this socket open: programs that this one starts need it, and Python closes all
// descriptors of those.
void keep_open(int inherited);

}  // namespace lockstep
