// Stands in for libFuzzer where the corpus is only replayed: hands every file
// of the folders named on the command line to the fuzzer it is linked with, and
// every file once more cut short and with single bytes changed, by a fixed
// pattern. Fails if there is no file.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

void Run(const std::string& content) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(content.data()),
                         content.size());
}

void RunWithChanges(const std::string& content) {
  Run(content);
  constexpr size_t kStep = 11;
  for (size_t at = 0; at < content.size(); at += kStep) {
    Run(content.substr(0, at));
    for (const char value : {'\0', '\x7f', '\xff', '9'}) {
      std::string changed = content;
      changed[at] = value;
      Run(changed);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int files = 0;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      if (!entry.is_regular_file()) continue;
      std::ostringstream content;
      content << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      RunWithChanges(content.str());
      ++files;
    }
  }
  std::printf("%d files\n", files);
  return files > 0 ? 0 : 1;
}
