// Data sets of universal files, one at a time, each from behind the line with
// its number to its end.

#ifndef PINODE_RECORD_FILES_UNIVERSAL_SETS_H_
#define PINODE_RECORD_FILES_UNIVERSAL_SETS_H_

#include <array>
#include <string>
#include <vector>

#include "pinode/record/files/universal_file.h"
#include "pinode/record/files/universal_text.h"

namespace pinode {

// The "    -1" behind a set.
[[nodiscard]] bool EndUniversalSet(UniversalLines* in, std::string* what);
// Texts of five lines; "NONE" is nothing.
void ReadUniversalTexts(UniversalLines* in, std::array<std::string, 5>* texts);

// 58; `header` is the line with the number, which says how bytes are ordered
// where the set is `binary`.
[[nodiscard]] bool ParseUniversalFunction(bool binary,
                                          const std::string& header,
                                          UniversalLines* in,
                                          UniversalFile* file,
                                          std::string* what);
// 15, of label and position on one of `lines`, and 2411, on two.
[[nodiscard]] bool ParseUniversalNodes(int lines, UniversalLines* in,
                                       UniversalFile* file, std::string* what);
// 18 and 2420. What cannot be read is a system that is not known, and no error
// where nobody asks for it.
void ParseUniversalSystems(UniversalLines* in, UniversalFile* file);
void ParseUniversalSystemMatrices(UniversalLines* in, UniversalFile* file);
// 82, and 2412: closed lines through the nodes of elements, beams as they are.
[[nodiscard]] bool ParseUniversalLine(UniversalLines* in, UniversalFile* file,
                                      std::string* what);
[[nodiscard]] bool ParseUniversalElements(UniversalLines* in,
                                          UniversalFile* file,
                                          std::string* what);
// 55.
[[nodiscard]] bool ParseUniversalShape(UniversalLines* in, UniversalFile* file,
                                       std::string* what);

// "abscissa from 0 by 0.0083333333333333332", where the columns of the two do
// not hold them; empty where they do.
std::string UniversalAbscissaNote(double start, double step);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_UNIVERSAL_SETS_H_
