#pragma once
#include <string>
#include <vector>

/// What a program left behind.
struct ProgramResult {
  int status = -1;  // exit status; -1 when a signal ended it
  std::string out, err;
};

/// Runs a program of this build (its name and arguments) and waits for its end.
ProgramResult runProgram(const std::vector<std::string>& words);

/// Path of a program of this build.
std::string programPath(const std::string& name);
