#include "pinode/base/printable.h"

#include <cstdint>
#include <cstdio>

#include "pinode/base/file.h"

namespace pinode {
namespace {

// Characters of a word and of a line that a message repeats. Longer ones lose
// their middle.
constexpr size_t kLongestWord = 300;
constexpr size_t kLongestLine = 4000;

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// Takes one character off the front of `text`. Returns its code, or -1 for a
// byte that is not part of valid UTF-8.
int32_t TakeCharacter(std::string_view* text, std::string* bytes) {
  const auto lead = static_cast<unsigned char>(text->front());
  const size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  *bytes = std::string(text->substr(0, length));
  if (FirstInvalidUtf8(*bytes) != std::string::npos) {
    *bytes = std::string(text->substr(0, 1));
    text->remove_prefix(1);
    return -1;
  }
  text->remove_prefix(bytes->size());
  if (length == 1) return lead;
  int32_t code = lead & (0xFF >> (length + 1));
  for (size_t i = 1; i < length; ++i) {
    code = (code << 6) | (static_cast<unsigned char>((*bytes)[i]) & 0x3F);
  }
  return code;
}

// True for what the Unicode standard has for controls, format characters and
// separators of lines. Joiners (U+200C, U+200D) are part of the writing of
// several languages and stay.
bool IsHidden(int32_t code) {
  return (code >= 0x80 && code < 0xA0) || code == 0xAD || code == 0x61C ||
         code == 0x180E || code == 0x200B || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
         (code >= 0xFFF9 && code <= 0xFFFB) ||
         (code >= 0xE0000 && code <= 0xE007F);
}

std::string Escaped(int32_t code, const std::string& bytes) {
  char text[16];
  if (code < 0) {
    std::snprintf(text, sizeof(text), "\\x%02X",
                  static_cast<unsigned char>(bytes[0]));
  } else if (code < 0x80) {
    std::snprintf(text, sizeof(text), "\\x%02X", static_cast<unsigned>(code));
  } else {
    std::snprintf(text, sizeof(text), "\\u{%X}", static_cast<unsigned>(code));
  }
  return text;
}

// Cuts out the middle, between characters, such that about `longest` bytes
// stay.
std::string WithoutMiddle(std::string_view text, size_t longest) {
  if (text.size() <= longest) return std::string(text);
  size_t begin = 2 * longest / 3;
  size_t end = text.size() - longest / 6;
  while (begin > 0 && IsContinuation(text[begin])) --begin;
  while (end < text.size() && IsContinuation(text[end])) ++end;
  return std::string(text.substr(0, begin)) + "...(" +
         std::to_string(end - begin) + " more)..." +
         std::string(text.substr(end));
}

std::string Escape(std::string_view text, bool one_line) {
  std::string result;
  std::string word;
  const auto end_word = [&]() {
    result += WithoutMiddle(word, kLongestWord);
    word.clear();
  };
  std::string bytes;
  while (!text.empty()) {
    const int32_t code = TakeCharacter(&text, &bytes);
    if (code == ' ' || (!one_line && (code == '\n' || code == '\t'))) {
      end_word();
      result += bytes;
    } else if (code == '\n') {
      word += "\\n";
    } else if (code == '\t') {
      word += "\\t";
    } else if (code == '\r') {
      word += "\\r";
    } else if (code < 0x20 || code == 0x7F || IsHidden(code)) {
      word += Escaped(code, bytes);
    } else {
      word += bytes;
    }
  }
  end_word();
  return result;
}

}  // namespace

std::string Printable(std::string_view text) { return Escape(text, false); }

std::string PrintableLine(std::string_view text) {
  return WithoutMiddle(Escape(text, true), kLongestLine);
}

std::string Clipped(const std::string& text, size_t width) {
  constexpr std::string_view kRest = "...";
  size_t characters = 0;
  size_t cut = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (IsContinuation(text[i])) continue;
    if (characters + kRest.size() == width) cut = i;
    if (++characters > width) return text.substr(0, cut) + std::string(kRest);
  }
  return text;
}

}  // namespace pinode
