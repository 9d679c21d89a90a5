// Small helpers for names and numbers in text.

#ifndef PINODE_BASE_STRINGS_H_
#define PINODE_BASE_STRINGS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// The entry of `known` that `name` was most likely meant to be: the one at the
// smallest edit distance (insertions, deletions, substitutions and swaps of
// neighbours; a difference of case alone counts nothing), the first such if
// several are equally near. Empty if even that one needs more edits than a
// third of the longer word (at least one).
std::string NearestName(const std::string& name,
                        const std::vector<std::string>& known);

// "; did you mean 'x'?" with the nearest known name, or, where none is near,
// "; known are: a, b, c". Empty if nothing is known. Written to be appended to
// an error message.
std::string NameHint(const std::string& name,
                     const std::vector<std::string>& known);

// Parses a whole text as one number, independently of the locale: decimal
// point, optional sign (also '+'), optional exponent introduced by e, E, d or
// D (Fortran), "nan" and "inf" in any case, blanks around it. False, with
// *value untouched, if anything else is found or the number overflows.
bool ParseDouble(std::string_view text, double* value);

// As ParseDouble for a decimal integer.
bool ParseInt(std::string_view text, int* value);
bool ParseInt(std::string_view text, int64_t* value);

// `value` with `digits` significant digits (1 to 17) as "%.<digits>g" would
// write it in the C locale; 0 digits: the shortest text that reads back to the
// same number.
std::string FormatNumber(double value, int digits = 0);

// Without blanks (space, tab, CR, LF) on both sides.
std::string_view StripBlanks(std::string_view text);

// The parts with `separator` between them.
std::string Join(const std::vector<std::string>& parts,
                 std::string_view separator);

// Every `from` (not empty) in *text becomes `to`.
void ReplaceAll(const std::string& from, const std::string& to,
                std::string* text);

}  // namespace pinode

#endif  // PINODE_BASE_STRINGS_H_
