#include "platform/tool/control_client.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "platform/ipc/unix_socket.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr timeval answer_timeout{10, 0};

std::string readAnswer(int socket) {
  std::string answer;
  char buffer[4096];
  for (;;) {
    const ssize_t got = ::recv(socket, buffer, sizeof buffer, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::runtime_error("the daemon does not answer");
    if (got == 0) return answer;
    answer.append(buffer, static_cast<std::size_t>(got));
  }
}

}  // namespace

std::string controlRequest(const std::string& socket_path, std::string_view line, int attached) {
  const sockaddr_un address = socketAddress(socket_path);
  const UniqueFd socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.valid()) throw std::system_error(errno, std::generic_category(), "socket");
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw InputError(socket_path + ": " + std::generic_category().message(errno) +
                     ", expected the socket of a running depthscoped");
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &answer_timeout, sizeof answer_timeout);
  const std::string request = std::string(line) + "\n";
  if (sendWithFd(socket.get(), request, attached) != static_cast<ssize_t>(request.size()))
    throw std::runtime_error("the daemon does not listen");
  std::string answer = readAnswer(socket.get());
  while (answer.ends_with('\n')) answer.pop_back();
  if (answer.starts_with("ok")) return answer.size() > 3 ? answer.substr(3) : std::string();
  throw std::runtime_error(answer.starts_with("error ") ? answer.substr(6)
                                                        : "the daemon does not answer");
}

}  // namespace depthscope::platform
