// Arbitrary bytes as frequency response functions: as a text, and as a
// universal file. Functions that belong together are written and read again.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pinode/record/files/universal_file.h"
#include "pinode/record/frf/frequency_responses.h"
#include "pinode/record/frf/frf_files.h"

namespace {

bool FromUniversal(const std::string& bytes,
                   std::vector<pinode::FrequencyResponse>* all) {
  pinode::UniversalFile file;
  std::string error;
  if (!pinode::ParseUniversalFile(bytes, "fuzzed", &file, &error)) return false;
  const bool is_read = pinode::FrfsOfUniversalFile(file, "fuzzed", all, &error);
  if (is_read != error.empty()) __builtin_trap();
  return is_read;
}

bool FromText(const std::string& text,
              std::vector<pinode::FrequencyResponse>* all) {
  std::vector<std::string> remarks;
  std::string error;
  all->assign(1, {});
  const bool is_read =
      pinode::ParseFrfText(text, "fuzzed", &all->front(), &remarks, &error);
  if (is_read != error.empty()) __builtin_trap();
  if (error.find('\n') != std::string::npos) __builtin_trap();
  // A case states what a text does not.
  all->front().response = "1:z";
  all->front().reference = "2:z";
  if (all->front().derivative < 0) all->front().derivative = 2;
  return is_read;
}

void PutTogether(const std::vector<pinode::FrequencyResponse>& single) {
  pinode::FrequencyResponses all;
  std::string error;
  const bool fits = pinode::AssembleFrequencyResponses(single, &all, &error);
  if (fits != error.empty()) __builtin_trap();
  if (!fits) return;
  if (!all.values.allFinite() || !all.frequencies_hz.allFinite() ||
      !all.coherence.allFinite()) {
    __builtin_trap();
  }
  std::vector<pinode::FrequencyResponse> again;
  if (!FromUniversal(pinode::FormatFrfFile(all, "m/s^2", "N"), &again) ||
      again.size() != single.size()) {
    __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  std::vector<pinode::FrequencyResponse> all;
  if (FromText(bytes, &all)) PutTogether(all);
  all.clear();
  if (FromUniversal(bytes, &all)) PutTogether(all);
  return 0;
}
