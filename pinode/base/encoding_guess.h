// A guess at the encoding of a text that states none.

#ifndef PINODE_BASE_ENCODING_GUESS_H_
#define PINODE_BASE_ENCODING_GUESS_H_

#include <cstdint>
#include <string>

namespace pinode {

// Encoding of one byte or of Asian scripts that a text may have.
struct EncodingGuess {
  // Name, as iconv knows it.
  std::string name;
  // Another encoding that gives other letters and is about as likely; empty:
  // none.
  std::string other;
  // True if the letters look wrong, or are too few to tell.
  bool is_unsure = false;
  // False if the letters look wrong in all encodings.
  bool fits = true;
  // Reason to refuse the text: `name` and `other` are equally likely, and give
  // different known units. Empty: there is none.
  std::string conflict;
};

// Guesses the encoding of a text that is neither ASCII nor UTF-8. uchardet
// looks at the lines with bytes beyond ASCII, as far as the first 256 KiB. Its
// answer competes with Windows-1252 and with the encodings that are often
// mistaken for each other. The one whose text looks least odd wins: words that
// mix scripts, symbols and capitals inside words, and control characters are
// odd. Known units speak for an encoding. Without uchardet only encodings
// of one byte are tried, and a guess other than Windows-1252 is unsure.
EncodingGuess GuessEncoding(const std::string& text);

// Converts the text from an encoding that iconv knows to UTF-8. Returns false
// if there is no such encoding, with *place = -1, or with the first byte that
// is none of it. *converted then is the text before that byte.
[[nodiscard]] bool ConvertByIconv(const std::string& encoding,
                                  const std::string& text,
                                  std::string* converted, int64_t* place);

// Converts as ConvertByIconv() does, with U+FFFD for each byte that is not text
// in the encoding. *place is the first of them, or the text's size.
[[nodiscard]] bool ConvertWithReplacements(const std::string& encoding,
                                           const std::string& text,
                                           std::string* converted,
                                           int64_t* place);

// Returns how odd a text of UTF-8 looks as names and units of channels: 0 for
// one that nothing speaks against.
int Oddness(const std::string& text);

}  // namespace pinode

#endif  // PINODE_BASE_ENCODING_GUESS_H_
