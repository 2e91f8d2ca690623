#include "platform/daemon/control_server.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "platform/ipc/unix_socket.hpp"
#include "platform/log.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr timeval client_patience{0, 200000};  // 200 ms
constexpr std::size_t longest_request = 512;

/// Does not wait where the other is too busy to answer.
bool somebodyListens(const sockaddr_un& address) {
  const UniqueFd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
         errno == EAGAIN;
}

}  // namespace

ControlServer::ControlServer(std::string path, Handler handler)
    : path_(std::move(path)), handler_(std::move(handler)) {
  const auto fail = [&](const std::string& why) {
    throw InputError(path_ + ": " + why +
                     ", expected a place for the control socket (daemon.control_socket)");
  };
  const sockaddr_un address = socketAddress(path_);
  if (somebodyListens(address)) fail("another depthscoped listens there");
  struct stat info {};
  if (::lstat(path_.c_str(), &info) == 0) {
    if (!S_ISSOCK(info.st_mode)) fail("is not a socket");
    ::unlink(path_.c_str());
  }
  socket_ = UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket_.valid() || ::fchmod(socket_.get(), 0660) != 0 ||
      ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::chmod(path_.c_str(), 0660) != 0 || ::listen(socket_.get(), 4) != 0)
    fail(std::generic_category().message(errno));
}

ControlServer::~ControlServer() {
  ::unlink(path_.c_str());
}

void ControlServer::serve() {
  for (;;) {
    const UniqueFd client(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!client.valid()) return;
    try {
      serveOne(client.get());
    } catch (const std::exception& error) {
      log(LogPriority::Warning, "control request failed", {{"error", error.what()}});
    }
  }
}

void ControlServer::serveOne(int client) {
  ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &client_patience, sizeof client_patience);
  ::setsockopt(client, SOL_SOCKET, SO_SNDTIMEO, &client_patience, sizeof client_patience);
  std::string line;
  UniqueFd attached;
  while (line.find('\n') == std::string::npos) {
    char buffer[longest_request];
    const ssize_t got = receiveWithFd(client, buffer, attached);
    if (got <= 0) return;
    line.append(buffer, static_cast<std::size_t>(got));
    if (line.size() > longest_request) return;
  }
  line.resize(line.find('\n'));
  const std::string answer = handler_(line, std::move(attached)) + "\n";
  ::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
}

}  // namespace depthscope::platform
