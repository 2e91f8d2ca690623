#pragma once
#include <sys/socket.h>
#include <sys/un.h>

#include <span>
#include <string>

#include "platform/unique_fd.hpp"

namespace depthscope::platform {

/// Address of a Unix socket. Throws InputError when the path is too long for one.
sockaddr_un socketAddress(const std::string& path);

/// Sends bytes, and a descriptor beside them unless it is -1. The number of bytes sent, or -1
/// (errno).
ssize_t sendWithFd(int socket, std::span<const char> bytes, int attached);

/// Receives bytes and takes a descriptor that came with them (close-on-exec). The number of bytes,
/// 0 at the peer's end, -1 on error (errno). Does not allocate.
ssize_t receiveWithFd(int socket, std::span<char> bytes, UniqueFd& attached, int flags = 0);

}  // namespace depthscope::platform
