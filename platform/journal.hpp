#pragma once
#include <string>
#include <string_view>

#include "platform/log.hpp"
#include "platform/unique_fd.hpp"

namespace depthscope::platform {

/// The journal by its native protocol (systemd.journal-fields(7),
/// systemd.io/JOURNAL_NATIVE_PROTOCOL), so that each field of a message can be asked for:
/// `journalctl DEPTHSCOPE_PID=12`. Never waits: a journal that is full or gone must not stop the
/// picture.
class Journal {
 public:
  static constexpr const char* system_socket = "/run/systemd/journal/socket";

  /// Not connected when nobody listens at `socket`.
  explicit Journal(const char* socket = system_socket);

  /// False when the journal did not take it.
  bool send(std::string_view entry) const;

 private:
  UniqueFd socket_;
};

/// One entry: PRIORITY, SYSLOG_IDENTIFIER, MESSAGE (the whole line, as a person reads it),
/// DEPTHSCOPE_EVENT (the message without its fields) and DEPTHSCOPE_<KEY> for each field. Control
/// characters are replaced, so that a value is always one line.
std::string journalEntry(LogPriority priority, std::string_view program, std::string_view message,
                         std::initializer_list<LogField> fields);

/// True when stderr is connected to the journal (JOURNAL_STREAM of systemd.exec(5)).
bool stderrIsJournal();

}  // namespace depthscope::platform
