// Lines and numbers of text files with a header and rows of numbers.

#ifndef PINODE_RECORD_FILES_LOGGERS_TEXT_LINES_H_
#define PINODE_RECORD_FILES_LOGGERS_TEXT_LINES_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/files/loggers/logged_file.h"

namespace pinode {

// Iterates over the lines of a text, without their ends.
class TextLines {
 public:
  TextLines(std::string_view text, const std::string& path)
      : text_(text), path_(path) {}

  // Returns false at the end of the text.
  bool Next(std::string_view* line);
  bool AtEnd() const { return position_ >= text_.size(); }
  size_t bytes() const { return text_.size(); }

  // Sets *error to `path:line: message` and returns false.
  bool Fail(const std::string& message, std::string* error) const;

 private:
  std::string_view text_;
  const std::string& path_;
  size_t position_ = 0;
  int64_t number_ = 0;
};

// Returns the words between blanks.
std::vector<std::string_view> WordsOf(std::string_view line);

// Reads `count` numbers from the next lines. `width` is the width of a number's
// field as in Fortran, whose numbers may touch; 0: numbers between blanks.
// Fails with `path:line: ...` for text, infinite numbers and too few of them.
[[nodiscard]] bool ReadNumbers(TextLines* lines, int64_t count, int width,
                               Vector* values, std::string* error);

// Returns the width of a field in a Fortran format such as "(8f10.5)", or 0.
int FortranWidth(std::string_view text);

// Parses the number of a clock time such as "13:06:45.25" into seconds.
[[nodiscard]] bool ParseTimeOfDay(std::string_view text, int64_t* seconds,
                                  double* fraction);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_TEXT_LINES_H_
