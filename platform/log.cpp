#include "platform/log.hpp"

#include <unistd.h>

#include <cerrno>

#include "platform/journal.hpp"
#include "platform/log_thread.hpp"

namespace depthscope::platform {
namespace {

void appendPrintable(std::string& out, std::string_view text) {
  for (char c : text) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
}

void appendValue(std::string& out, std::string_view text) {
  if (!text.empty() && text.find_first_of(" \"=\t\n\\") == std::string_view::npos) {
    appendPrintable(out, text);
    return;
  }
  out += '"';
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    appendPrintable(out, {&c, 1});
  }
  out += '"';
}

bool underJournal() {
  static const bool under_journal = stderrIsJournal();
  return under_journal;
}

}  // namespace

std::string formatLogLine(LogPriority priority, std::string_view message,
                          std::initializer_list<LogField> fields, bool journal) {
  std::string line;
  if (journal) line = {'<', static_cast<char>('0' + static_cast<int>(priority)), '>'};
  appendPrintable(line, message);
  for (const LogField& field : fields) {
    line += ' ';
    line += field.key;
    line += '=';
    appendValue(line, field.value);
  }
  return line;
}

LogEntry makeLogEntry(LogPriority priority, std::string_view message,
                      std::initializer_list<LogField> fields) {
  LogEntry entry{formatLogLine(priority, message, fields, underJournal()), {}};
  entry.line += '\n';
  if (underJournal())
    entry.journal = journalEntry(priority, program_invocation_short_name, message, fields);
  return entry;
}

void writeLogEntry(const LogEntry& entry) {
  if (!entry.journal.empty()) {
    static const Journal journal;
    if (journal.send(entry.journal)) return;
  }
  // A log that cannot be written must not stop the picture: the result is of no use.
  [[maybe_unused]] const ssize_t written =
      ::write(STDERR_FILENO, entry.line.data(), entry.line.size());
}

void log(LogPriority priority, std::string_view message, std::initializer_list<LogField> fields) {
  LogEntry entry = makeLogEntry(priority, message, fields);
  if (!LogThread::take(entry)) writeLogEntry(entry);
}

}  // namespace depthscope::platform
