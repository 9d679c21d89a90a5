// Numbers and formats as Fortran programs write them into fixed columns. Not
// meant for other layers.

#ifndef PINODE_STRUCTURE_MATRICES_FORTRAN_TEXT_H_
#define PINODE_STRUCTURE_MATRICES_FORTRAN_TEXT_H_

#include <string_view>

namespace pinode {

// Layout of a line of numbers: `1P,5E16.9` and `(5E16.9)` mean five fields of
// 16 places.
struct FortranFormat {
  char letter = 'E';  // I, or one of E, D, F, G
  int count = 1;
  int width = 16;
};

// Parses a format of one kind of numbers, with or without parentheses, repeated
// groups (`(4(1PE20.13))`) included. Returns false for any other, and for a
// scale factor beside F, which would change the values.
bool ParseFortranFormat(std::string_view text, FortranFormat* format);

// Returns a field of fixed columns, without its blanks: numbers may touch each
// other. A field beyond the end of the line is empty.
std::string_view FixedField(std::string_view line, int index, int width);

// Does what ParseDouble does, also for exponents without a letter: `1.5-101`
// of Fortran, `3.+5` of Nastran.
bool ParseFortranDouble(std::string_view text, double* value);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_FORTRAN_TEXT_H_
