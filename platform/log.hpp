#pragma once
#include <charconv>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>

namespace depthscope::platform {

/// Priorities of syslog, as the journal knows them.
enum class LogPriority { Error = 3, Warning = 4, Notice = 5, Info = 6, Debug = 7 };

/// One key=value of a log line.
struct LogField {
  std::string_view key;
  std::string value;

  LogField(std::string_view k, std::string_view v) : key(k), value(v) {}
  LogField(std::string_view k, const char* v) : key(k), value(v) {}
  LogField(std::string_view k, const std::string& v) : key(k), value(v) {}
  template <class T>
  requires std::is_arithmetic_v<T> LogField(std::string_view k, T v) : key(k) {
    if constexpr (std::is_same_v<T, bool>) {
      value = v ? "true" : "false";
    } else {
      char buffer[32];
      value.assign(buffer, std::to_chars(buffer, buffer + sizeof buffer, v).ptr);
    }
  }
};

/// Writes one line to stderr: `message key=value ...`, in one write, so that lines of several
/// threads do not mix; values with spaces are quoted, control characters replaced. Where stderr is
/// the journal's, the message goes to the journal with its fields (platform/journal.hpp); should
/// that not take it, the line starts with its priority as sd-daemon(3) defines it. Waits for
/// whoever reads the log, unless there is a LogThread (platform/log_thread.hpp), as in the video
/// process.
void log(LogPriority priority, std::string_view message,
         std::initializer_list<LogField> fields = {});

/// The two halves of log().
struct LogEntry;
LogEntry makeLogEntry(LogPriority priority, std::string_view message,
                      std::initializer_list<LogField> fields);
void writeLogEntry(const LogEntry& entry);

/// The line that log() writes, without the newline.
std::string formatLogLine(LogPriority priority, std::string_view message,
                          std::initializer_list<LogField> fields, bool journal);

}  // namespace depthscope::platform
