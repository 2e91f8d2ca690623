#include "platform/journal.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cctype>
#include <cstdlib>
#include <cstring>

namespace depthscope::platform {
namespace {

void append(std::string& entry, std::string_view name, std::string_view value) {
  for (char c : name)
    entry += std::isalnum(static_cast<unsigned char>(c))
                 ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
                 : '_';
  entry += '=';
  for (char c : value) entry += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  entry += '\n';
}

}  // namespace

Journal::Journal(const char* socket)
    : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socket, sizeof address.sun_path - 1);
  if (::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    socket_.reset();
}

bool Journal::send(std::string_view entry) const {
  return socket_.valid() && ::send(socket_.get(), entry.data(), entry.size(), MSG_NOSIGNAL) ==
                                static_cast<ssize_t>(entry.size());
}

std::string journalEntry(LogPriority priority, std::string_view program, std::string_view message,
                         std::initializer_list<LogField> fields) {
  std::string entry;
  append(entry, "PRIORITY", std::to_string(static_cast<int>(priority)));
  append(entry, "SYSLOG_IDENTIFIER", program);
  append(entry, "MESSAGE", formatLogLine(priority, message, fields, false));
  append(entry, "DEPTHSCOPE_EVENT", message);
  for (const LogField& field : fields)
    append(entry, "DEPTHSCOPE_" + std::string(field.key), field.value);
  return entry;
}

bool stderrIsJournal() {
  const char* stream = std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe)
  struct stat info {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &info) == 0 &&
         stream == std::to_string(info.st_dev) + ":" + std::to_string(info.st_ino);
}

}  // namespace depthscope::platform
