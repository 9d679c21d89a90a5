// Parses data sets of universal files, one at a time. Each function reads from
// behind the line with the set's number to the set's end.

#ifndef PINODE_RECORD_FILES_UNIVERSAL_SETS_H_
#define PINODE_RECORD_FILES_UNIVERSAL_SETS_H_

#include <array>
#include <string>
#include <vector>

#include "pinode/record/files/universal_file.h"
#include "pinode/record/files/universal_text.h"

namespace pinode {

// Reads the "    -1" behind a set.
[[nodiscard]] bool EndUniversalSet(UniversalLines* in, std::string* what);
// Reads texts of five lines. "NONE" means an empty text.
void ReadUniversalTexts(UniversalLines* in, std::array<std::string, 5>* texts);

// Parses set 58. `header` is the line with the number. If the set is `binary`,
// it gives the byte order.
[[nodiscard]] bool ParseUniversalFunction(bool binary,
                                          const std::string& header,
                                          UniversalLines* in,
                                          UniversalFile* file,
                                          std::string* what);
// Parses set 15, with label and position on one of `lines`, and set 2411, on
// two lines.
[[nodiscard]] bool ParseUniversalNodes(int lines, UniversalLines* in,
                                       UniversalFile* file, std::string* what);
// Parses sets 18 and 2420. A system that cannot be read counts as unknown. It
// is an error only if it is needed.
void ParseUniversalSystems(UniversalLines* in, UniversalFile* file);
void ParseUniversalSystemMatrices(UniversalLines* in, UniversalFile* file);
// Parse set 82, and set 2412 as closed lines through the nodes of elements.
// Beams stay open.
[[nodiscard]] bool ParseUniversalLine(UniversalLines* in, UniversalFile* file,
                                      std::string* what);
[[nodiscard]] bool ParseUniversalElements(UniversalLines* in,
                                          UniversalFile* file,
                                          std::string* what);
// Parses set 55.
[[nodiscard]] bool ParseUniversalShape(UniversalLines* in, UniversalFile* file,
                                       std::string* what);

// Returns "abscissa from 0 by 0.0083333333333333332" if the columns cannot hold
// the two numbers, else an empty text.
std::string UniversalAbscissaNote(double start, double step);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_UNIVERSAL_SETS_H_
