#include "platform/config/setting_table.hpp"

#include <charconv>

namespace depthscope::platform {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};

/// The shortest text that reads back as the same number.
template <class T>
std::string numberText(T value) {
  char buffer[64];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, result.ptr};
}

template <class T>
std::string realText(T value) {
  std::string text = numberText(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string rangeText(const Setting& s) {
  return numberText(s.min) + " to " + numberText(s.max);
}

}  // namespace

std::string expectation(const Setting& setting) {
  return std::visit(
      Overloaded{[](bool*) -> std::string { return "true or false"; },
                 [&](int*) { return "an integer from " + rangeText(setting); },
                 [&](std::int64_t*) { return "an integer from " + rangeText(setting); },
                 [&](float*) { return "a number from " + rangeText(setting); },
                 [&](double*) { return "a number from " + rangeText(setting); },
                 [](std::string*) -> std::string { return "a text in quotes"; },
                 [](const ChoiceField& choice) {
                   std::string text = "one of";
                   for (std::size_t i = 0; i < choice.names.size(); ++i)
                     text += (i ? ", " : " ") + quoted(choice.names[i]);
                   return text;
                 }},
      setting.field);
}

std::string valueAsToml(const Setting& setting) {
  return std::visit(
      Overloaded{[](bool* v) -> std::string { return *v ? "true" : "false"; },
                 [](int* v) { return numberText(*v); },
                 [](std::int64_t* v) { return numberText(*v); },
                 [](float* v) { return realText(*v); }, [](double* v) { return realText(*v); },
                 [](std::string* v) { return quoted(*v); },
                 [](const ChoiceField& choice) { return quoted(choice.names[choice.get()]); }},
      setting.field);
}

}  // namespace depthscope::platform
