// Conversion of text files to UTF-8.

#ifndef PINODE_BASE_TEXT_ENCODING_H_
#define PINODE_BASE_TEXT_ENCODING_H_

#include <string>

namespace pinode {

// Encoding that a text was converted from.
struct TextEncoding {
  // Name, as iconv knows it.
  std::string name = "UTF-8";
  // True if letters beyond ASCII may be others. Rows of numbers are the same; a
  // sign of an Asian name may look like a bar or a bracket.
  bool is_guess = false;
  // Another encoding that is about as likely; empty: none is known.
  std::string other;
  // True if the letters look wrong, or are too few to tell.
  bool is_unsure = false;
  // False if the letters look wrong in all encodings that were tried.
  bool fits = true;
  // First byte that is not text in a guessed encoding, as a sentence; empty:
  // there is none. U+FFFD stands for such bytes.
  std::string flaw;

  // Returns what to tell a user: "WINDOWS-1252 (a guess)", or with the key that
  // decides.
  std::string AsText() const;
};

// Converts *text to UTF-8 and drops a byte order mark. `encoding` is a name
// that iconv knows; empty: it is found by these rules, in this order:
//
//   1. a byte order mark (UTF-8, UTF-16),
//   2. zeros in most bytes of one parity: UTF-16,
//   3. valid UTF-8 is UTF-8,
//   4. else the guess of GuessEncoding(). Its letters are those of the whole
//      text: a byte that is not text in it becomes U+FFFD.
//
// An encoding that adds characters to the one that was found or given takes its
// place where the text needs that: CP932 for SHIFT_JIS, UHC for EUC-KR.
// Fails for an unknown encoding, for bytes that are not text in it, for binary
// files, and if two guesses are as likely but give different units. *error has
// no path.
[[nodiscard]] bool ConvertToUtf8(const std::string& encoding, std::string* text,
                                 TextEncoding* found, std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_TEXT_ENCODING_H_
