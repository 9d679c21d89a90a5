// The README's C++ program with files in place of printed lines: identifies a
// case by Identify and writes the result files.
//
//   identify_case CASE FOLDER
//
// Exit status as pinode_update: 0 usable, 1 not usable, 2 bad input.

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "pinode/pinode.h"

int main(int argc, char** argv) {
  std::string error = "usage: identify_case CASE FOLDER";
  pinode::Case c;
  if (argc != 3 || !pinode::ReadCase(argv[1], &c, &error)) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 2;
  }
  c.options.num_threads = 1;
  const pinode::Identification result =
      pinode::Identify(c.problem, c.options, pinode::ExtrasOf(c));
  std::error_code ignored;
  std::filesystem::create_directories(argv[2], ignored);
  if (!pinode::WriteResultFiles(result.problem, result.summary, result.model,
                                argv[2], &error)) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 2;
  }
  return result.summary.usable() ? 0 : 1;
}
