#include "pinode/base/text_encoding.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"

namespace pinode {
namespace {

bool BeginsWith(const std::string& text, const std::string& mark) {
  return text.compare(0, mark.size(), mark) == 0;
}

// Returns "UTF-16LE" or "UTF-16BE" for a text without a mark whose bytes of
// one parity are nearly all zero, as ASCII in UTF-16 has them.
std::string Utf16WithoutMark(const std::string& text) {
  const size_t size = std::min<size_t>(text.size(), 4096);
  if (size < 4) return "";
  std::array<size_t, 2> zeros = {0, 0};
  for (size_t i = 0; i < size; ++i) {
    if (text[i] == '\0') ++zeros[i % 2];
  }
  const size_t most = size / 2 - size / 20;
  if (zeros[1] >= most && zeros[0] == 0) return "UTF-16LE";
  if (zeros[0] >= most && zeros[1] == 0) return "UTF-16BE";
  return "";
}

bool Convert(const std::string& encoding, std::string* text,
             std::string* error) {
  const iconv_t converter = iconv_open("UTF-8", encoding.c_str());
  // iconv_open returns this value on failure.
  if (converter == reinterpret_cast<iconv_t>(-1)) {
    *error = "encoding '" + encoding +
             "' is not known, expected a name that iconv knows, such as "
             "UTF-8, ISO-8859-1, WINDOWS-1252, SHIFT_JIS or UTF-16LE";
    return false;
  }
  std::string converted;
  converted.reserve(text->size() + text->size() / 8);
  char* from = text->data();
  size_t left = text->size();
  bool ok = true;
  std::array<char, 1 << 14> buffer;
  while (ok && left > 0) {
    char* to = buffer.data();
    size_t room = buffer.size();
    const size_t status = iconv(converter, &from, &left, &to, &room);
    converted.append(buffer.data(), buffer.size() - room);
    ok = status != static_cast<size_t>(-1) || errno == E2BIG;
  }
  iconv_close(converter);
  if (!ok) {
    const size_t place = text->size() - left;
    const auto lines = std::count(converted.begin(), converted.end(), '\n') + 1;
    *error = "byte " + std::to_string(place + 1) + " (line " +
             std::to_string(lines) + ") is not text in " + encoding +
             "; set `encoding` to that of the file";
    return false;
  }
  *text = std::move(converted);
  return true;
}

}  // namespace

bool ConvertToUtf8(const std::string& encoding, std::string* text,
                   std::string* found, bool* is_guess, std::string* error) {
  CHECK(text != nullptr);
  CHECK(found != nullptr);
  CHECK(is_guess != nullptr);
  CHECK(error != nullptr);
  *is_guess = false;
  std::string mark_says;
  if (BeginsWith(*text, "\xEF\xBB\xBF")) mark_says = "UTF-8";
  if (BeginsWith(*text, "\xFF\xFE")) mark_says = "UTF-16LE";
  if (BeginsWith(*text, "\xFE\xFF")) mark_says = "UTF-16BE";
  if (!mark_says.empty()) text->erase(0, mark_says == "UTF-8" ? 3 : 2);
  *found = !encoding.empty()    ? encoding
           : !mark_says.empty() ? mark_says
                                : Utf16WithoutMark(*text);
  if (found->empty() && text->find('\0') != std::string::npos) {
    *error =
        "is a binary file; expected text, or an extension of a known format "
        "(.mat, .npy, .npz, .h5, .uff, .unv, .at2)";
    return false;
  }
  if (found->empty() || *found == "UTF-8") {
    *found = "UTF-8";
    if (FirstInvalidUtf8(*text) == std::string::npos) return true;
    if (encoding.empty() && mark_says.empty()) {
      *found = "WINDOWS-1252";
      *is_guess = true;
      // Five bytes mean nothing in Windows-1252.
      if (text->find_first_of("\x81\x8D\x8F\x90\x9D") != std::string::npos) {
        *found = "ISO-8859-1";
      }
    }
  }
  return Convert(*found, text, error);
}

}  // namespace pinode
