// Small functions for names and numbers in text.

#ifndef PINODE_BASE_STRINGS_H_
#define PINODE_BASE_STRINGS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Returns the entry of `known` that `name` most likely means. It has the
// smallest edit distance to `name` (insertions, deletions, substitutions and
// swaps of neighbours; differences of case are free). The first of several
// equally near entries wins. Empty if even the nearest entry needs more edits
// than a third of the longer word (at least one).
std::string NearestName(const std::string& name,
                        const std::vector<std::string>& known);

// Returns "; did you mean 'x'?" with the nearest known name. If none is near,
// returns "; known are: a, b, c". Empty if `known` is empty. Append it to an
// error message.
std::string NameHint(const std::string& name,
                     const std::vector<std::string>& known);

// Parses a whole text as one number, independently of the locale: decimal
// point, optional sign (also '+'), optional exponent introduced by e, E, d or D
// (Fortran), "nan" and "inf" in any case, blanks around it. Returns false, with
// *value unchanged, for any other text or if the number overflows.
bool ParseDouble(std::string_view text, double* value);

// Does what ParseDouble does, for a decimal integer.
bool ParseInt(std::string_view text, int* value);
bool ParseInt(std::string_view text, int64_t* value);

// Returns `value` with `digits` significant digits (1 to 17), as "%.<digits>g"
// writes it in the C locale. With 0 digits, returns the shortest text that
// reads back to the same number.
std::string FormatNumber(double value, int digits = 0);

// Returns `text` without blanks (space, tab, CR, LF) on both sides.
std::string_view StripBlanks(std::string_view text);

// Returns the parts joined with `separator` between them.
std::string Join(const std::vector<std::string>& parts,
                 std::string_view separator);

// Replaces every `from` (not empty) in *text by `to`.
void ReplaceAll(const std::string& from, const std::string& to,
                std::string* text);

}  // namespace pinode

#endif  // PINODE_BASE_STRINGS_H_
