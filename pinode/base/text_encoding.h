// Conversion of text files to UTF-8.

#ifndef PINODE_BASE_TEXT_ENCODING_H_
#define PINODE_BASE_TEXT_ENCODING_H_

#include <string>

namespace pinode {

// Converts *text to UTF-8 and drops a byte order mark. `encoding` is a name
// that iconv knows; empty: it is found by these rules, in this order:
//
//   1. a byte order mark (UTF-8, UTF-16),
//   2. zeros in nearly every second byte: UTF-16,
//   3. valid UTF-8 is UTF-8,
//   4. else Windows-1252, which is Latin-1 with a few more characters.
//
// Rule 4 is a guess, and concerns letters beyond ASCII only: delimiters and
// numbers are the same in all encodings of one byte. *found is the encoding's
// name, and *is_guess says that rule 4 was used.
//
// Fails for an unknown encoding, for bytes that are not text in it, and for
// binary files. *error has no path.
[[nodiscard]] bool ConvertToUtf8(const std::string& encoding, std::string* text,
                                 std::string* found, bool* is_guess,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_TEXT_ENCODING_H_
