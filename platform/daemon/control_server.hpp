#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "platform/unique_fd.hpp"

namespace depthscope::platform {

/// The control socket: one line in, one answer out, then the connection ends. A client has a short
/// time to say what it wants; no client can hold the service up for longer.
class ControlServer {
 public:
  /// Answers a request ("ok ..." or "error ..."); `attached` is a descriptor that came with it, or
  /// invalid.
  using Handler = std::function<std::string(std::string_view line, UniqueFd attached)>;

  /// Listens at `path`, for user and group; a stale socket there is replaced. Throws InputError
  /// when the path cannot be had or another daemon listens there.
  ControlServer(std::string path, Handler handler);
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  int fd() const { return socket_.get(); }
  /// Serves the clients that wait. Does not throw.
  void serve();

 private:
  void serveOne(int client);

  std::string path_;
  Handler handler_;
  UniqueFd socket_;
};

}  // namespace depthscope::platform
