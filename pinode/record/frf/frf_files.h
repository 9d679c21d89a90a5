// Reads files with frequency response functions.

#ifndef PINODE_RECORD_FRF_FRF_FILES_H_
#define PINODE_RECORD_FRF_FRF_FILES_H_

#include <string>
#include <vector>

#include "pinode/record/frf/frequency_responses.h"

namespace pinode {

struct UniversalFile;

// Facts about a file that it may not state itself.
struct FrfFileOptions {
  // Places for each FRF in their order, one for all, or empty: as the file has
  // them.
  std::vector<std::string> responses;
  std::vector<std::string> references;
  // 0: receptance, 1: mobility, 2: accelerance; -1: as the file states.
  int derivative = -1;
};

// Reads the FRFs of a file:
//
// - universal files (.uff, .unv): data sets 58 of function type 4, with the
//   coherence (type 6) of the same places;
// - text with a column of frequencies, and columns of real and imaginary part
//   or of magnitude and phase, such as the export of SignalCalc. A coherence
//   may stand beside them. Any encoding; also gzipped.
//
// A magnitude that is negative, or whose name or unit is dB, is 20 log10 of the
// value. A phase is in degrees if its name or unit says so, or if it exceeds
// pi; wraps do not matter. *remarks says what was assumed.
//
// Fails with one line `path:line: what`.
[[nodiscard]] bool ReadFrfFile(const std::string& path,
                               const FrfFileOptions& options,
                               std::vector<FrequencyResponse>* all,
                               std::vector<std::string>* remarks,
                               std::string* error);

// Returns a universal file of the functions, and of their coherence where it is
// known, which ReadFrfFile reads. Units of motion and force are names for its
// axes. A line of text states the exponential window.
std::string FormatFrfFile(const FrequencyResponses& all,
                          const std::string& unit,
                          const std::string& force_unit);

// Does the same as ReadFrfFile for a text in memory.
[[nodiscard]] bool ParseFrfText(const std::string& text,
                                const std::string& path,
                                FrequencyResponse* response,
                                std::vector<std::string>* remarks,
                                std::string* error);

// Returns the FRFs of a universal file in memory. `path` is for messages.
[[nodiscard]] bool FrfsOfUniversalFile(const UniversalFile& file,
                                       const std::string& path,
                                       std::vector<FrequencyResponse>* all,
                                       std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FRF_FRF_FILES_H_
