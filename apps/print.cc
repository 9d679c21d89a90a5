#include "apps/print.h"

#include <cstdarg>
#include <cstdio>
#include <string>

#include "pinode/base/printable.h"

namespace pinode {
namespace {

std::string Format(const char* format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  if (size <= 0) return "";
  // One more for the zero at the end.
  std::string text(static_cast<size_t>(size) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, arguments);
  text.pop_back();
  return text;
}

}  // namespace

void Print(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const std::string text = Printable(Format(format, arguments));
  va_end(arguments);
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void PrintError(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const std::string text = PrintableLine(Format(format, arguments)) + "\n";
  va_end(arguments);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace pinode
