#include "pinode/base/text_encoding.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "pinode/base/encoding_guess.h"
#include "pinode/base/file.h"
#include "pinode/base/logging.h"

namespace pinode {
namespace {

bool BeginsWith(const std::string& text, const std::string& mark) {
  return text.compare(0, mark.size(), mark) == 0;
}

// True for bytes that are letters, digits or blanks of Latin-1.
bool IsPrintableOrBlank(char c) {
  return (c >= ' ' && c <= '~') || static_cast<unsigned char>(c) >= 0xA0 ||
         c == '\t' || c == '\r' || c == '\n';
}

// Returns "UTF-16LE" or "UTF-16BE" for a text without a mark whose bytes of one
// parity are mostly zero, as ASCII in UTF-16 has them; else "". Names in other
// letters may be among them.
std::string Utf16WithoutMark(const std::string& text) {
  const size_t size = std::min<size_t>(text.size(), 4096) / 2 * 2;
  if (size < 4) return "";
  std::array<size_t, 2> zeros = {0, 0};
  for (size_t i = 0; i < size; ++i) {
    if (text[i] != '\0') continue;
    // Binary numbers have zeros beside bytes that are no letters.
    if (!IsPrintableOrBlank(text[i % 2 == 0 ? i + 1 : i - 1])) return "";
    ++zeros[i % 2];
  }
  const size_t most = size / 4;
  if (zeros[1] >= most && zeros[0] == 0) return "UTF-16LE";
  if (zeros[0] >= most && zeros[1] == 0) return "UTF-16BE";
  return "";
}

// Returns the encoding of Windows that adds characters to another one; "":
// there is none.
std::string Superset(const std::string& encoding) {
  std::string upper = encoding;
  for (char& c : upper) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  for (const auto& [names, superset] :
       {std::pair(" SHIFT_JIS SHIFT-JIS SJIS ", "CP932"),
        std::pair(" EUC-KR EUCKR ", "UHC"),
        std::pair(" GB2312 EUC-CN GBK ", "GB18030"),
        std::pair(" ISO-8859-7 ", "WINDOWS-1253")}) {
    if (std::string(names).find(" " + upper + " ") != std::string::npos) {
      return superset;
    }
  }
  return "";
}

// Says which byte is not text in an encoding. `before` is the text before it.
std::string NotTextIn(const std::string& encoding, int64_t place,
                      const std::string& before) {
  const auto lines = std::count(before.begin(), before.end(), '\n') + 1;
  return "byte " + std::to_string(place + 1) + " (line " +
         std::to_string(lines) + ") is not text in " + encoding;
}

// Converts from found->name, or from a superset that gives the same text as far
// as found->name goes.
bool Convert(std::string* text, TextEncoding* found, std::string* error) {
  std::string converted;
  int64_t place = 0;
  if (ConvertByIconv(found->name, *text, &converted, &place)) {
    *text = std::move(converted);
    return true;
  }
  if (place < 0) {
    *error = "encoding '" + found->name +
             "' is not known, expected a name that iconv knows, such as "
             "UTF-8, WINDOWS-1252, WINDOWS-1251, GB18030, SHIFT_JIS, EUC-KR "
             "or UTF-16LE";
    return false;
  }
  const std::string superset = Superset(found->name);
  std::string whole;
  int64_t unused = 0;
  if (!superset.empty() && ConvertByIconv(superset, *text, &whole, &unused) &&
      BeginsWith(whole, converted)) {
    found->name = superset;
    *text = std::move(whole);
    return true;
  }
  *error = NotTextIn(found->name, place, converted) +
           "; set `encoding` to that of the file";
  return false;
}

// Converts a text of a guessed encoding. Its rest may have other bytes than its
// beginning, whose letters stay as they are. Fails if two encodings are as
// likely, and give different units.
bool ConvertGuess(std::string* text, TextEncoding* found, std::string* error) {
  const EncodingGuess guess = GuessEncoding(*text);
  found->is_guess = true;
  found->name = guess.name;
  found->other = guess.other;
  found->is_unsure = guess.is_unsure;
  found->fits = guess.fits;
  if (!guess.conflict.empty()) {
    *error = guess.conflict + "; set `encoding` to that of the file";
    return false;
  }
  if (Convert(text, found, error)) return true;
  error->clear();
  std::string converted;
  int64_t place = 0;
  if (!ConvertWithReplacements(found->name, *text, &converted, &place)) {
    return false;
  }
  found->flaw = NotTextIn(found->name, place,
                          text->substr(0, static_cast<size_t>(place)));
  *text = std::move(converted);
  return true;
}

}  // namespace

std::string TextEncoding::AsText() const {
  if (!is_guess) return name;
  const std::string end = flaw.empty() ? "" : "; " + flaw;
  if (!fits) {
    return name +
           ", but no known encoding fits: set `encoding` if names look wrong" +
           end;
  }
  if (!other.empty()) {
    return name + " or " + other +
           ", read as the first: set `encoding` if names look wrong" + end;
  }
  if (is_unsure) {
    return name +
           ", a guess from too few letters: set `encoding` if names look "
           "wrong" +
           end;
  }
  return name + " (a guess)" + end;
}

bool ConvertToUtf8(const std::string& encoding, std::string* text,
                   TextEncoding* found, std::string* error) {
  CHECK(text != nullptr);
  CHECK(found != nullptr);
  CHECK(error != nullptr);
  *found = TextEncoding();
  std::string mark_says;
  if (BeginsWith(*text, "\xEF\xBB\xBF")) mark_says = "UTF-8";
  if (BeginsWith(*text, "\xFF\xFE")) mark_says = "UTF-16LE";
  if (BeginsWith(*text, "\xFE\xFF")) mark_says = "UTF-16BE";
  if (!mark_says.empty()) text->erase(0, mark_says == "UTF-8" ? 3 : 2);
  std::string name = !encoding.empty()    ? encoding
                     : !mark_says.empty() ? mark_says
                                          : Utf16WithoutMark(*text);
  if (name.empty() && text->find('\0') != std::string::npos) {
    *error =
        "is a binary file; expected text, or an extension of a known format "
        "(.mat, .npy, .npz, .h5, .uff, .unv, .at2)";
    return false;
  }
  if (name.empty() || name == "UTF-8") {
    if (FirstInvalidUtf8(*text) == std::string::npos) return true;
    if (encoding.empty() && mark_says.empty()) {
      return ConvertGuess(text, found, error);
    }
  }
  if (name.empty()) name = "UTF-8";
  found->name = name;
  return Convert(text, found, error);
}

}  // namespace pinode
