#include "platform/log.hpp"

#include <unistd.h>

#include <cerrno>

#include "platform/journal.hpp"

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

void log(LogPriority priority, std::string_view message, std::initializer_list<LogField> fields) {
  static const bool under_journal = stderrIsJournal();
  if (under_journal) {
    static const Journal journal;
    if (journal.send(journalEntry(priority, program_invocation_short_name, message, fields)))
      return;
  }
  std::string line = formatLogLine(priority, message, fields, under_journal);
  line += '\n';
  // A log that cannot be written must not stop the picture: the result is of no use.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace depthscope::platform
