// ask REQUEST: one request to the daemon's control socket, its answer on stdout. What `depthscope
// status --json` does, without the seconds that the user's tool takes to load its libraries on an
// emulated processor.
#include <cstdio>
#include <exception>
#include <string>

#include "platform/config/settings.hpp"
#include "platform/tool/control_client.hpp"

int main(int argc, char** argv) {
  using namespace depthscope::platform;
  if (argc != 2) return std::fputs("usage: ask REQUEST\n", stderr), 2;
  try {
    std::puts(controlRequest(DaemonSettings().control_socket, argv[1]).c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ask: %s\n", error.what());
    return 1;
  }
}
