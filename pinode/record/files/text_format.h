// Form of a text file, as far as a user gives it.

#ifndef PINODE_RECORD_FILES_TEXT_FORMAT_H_
#define PINODE_RECORD_FILES_TEXT_FORMAT_H_

#include <string>
#include <utility>
#include <vector>

namespace pinode {

// Form of a text file with columns. What is not set is found from the text.
struct TextFormat {
  // Name of the encoding, as iconv knows it.
  std::string encoding;
  // Number of lines above the first row of numbers; -1: found.
  int header_lines = -1;
  // '\t', ';', ',', '|', or ' ' for blanks; 0: found.
  char delimiter = 0;
  // '.' or ','; 0: found.
  char decimal = 0;
  // Format of clock times, as strptime (POSIX) has it, with %f for a fraction.
  std::string time_format;
  // Column that is the time; empty: none. Only its clock times are read.
  std::string time_column;
  // Unit of the time column if it holds numbers; empty: that of the file, else
  // seconds.
  std::string time_unit;

  // All fields in one text, to compare and pass them.
  std::string AsText() const;

  // Keys of a record and their values: those of encoding, header lines,
  // delimiter, decimal sign and format of times that are set.
  std::vector<std::pair<std::string, std::string>> Keys() const;
};

// Sets the fields that keys of a record stand for, and `time_unit`; an empty
// value is not given. The delimiters tab and blank may be written as words. On
// failure returns false, with the bad key in *key and what is wrong with its
// value in *error.
[[nodiscard]] bool ParseTextFormat(
    const std::vector<std::pair<std::string, std::string>>& keys,
    TextFormat* format, std::string* key, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_FORMAT_H_
