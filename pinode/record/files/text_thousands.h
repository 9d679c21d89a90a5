// Separators of thousands in the numbers of a text file.

#ifndef PINODE_RECORD_FILES_TEXT_THOUSANDS_H_
#define PINODE_RECORD_FILES_TEXT_THOUSANDS_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "pinode/record/files/text_rows.h"

namespace pinode {

// Rewrites a number with separated thousands, such as 1'234.5 or, with a
// decimal comma, 1.234,5, as JoinThousands() = 1234.5. A minus sign of
// typographers becomes a hyphen. Apostrophes and blanks that do not break a
// line can only be separators. A point, a comma or a plain blank is one if a
// decimal sign or a second separator follows, or if `is_sure`. Returns false
// for all other text.
[[nodiscard]] bool JoinThousands(std::string_view cell, char decimal,
                                 bool is_sure, std::string* joined);

// True if some cells of the rows may need JoinThousands().
bool MayHaveThousands(std::string_view rows);

// Number that can be read in two ways; an empty text: none.
struct DoubtfulNumber {
  std::string text;
  int64_t line = 0;
};

// Finds a number of a run with decimal points that may have its point between
// thousands. In such a column all points stand before the last three digits,
// and other cells are short whole numbers: 12 and 1.250. Any number of another
// form tells that points are decimal. All rows are searched for one, since the
// first number above 999 may stand far below. `rows` begins with the run, in
// line `first_line`.
DoubtfulNumber DoubtfulThousands(std::string_view rows, int64_t first_line,
                                 const RowRun& run);

// Watches numbers with decimal commas: a comma before three digits may part
// thousands, until a number of another form comes.
class CommaWatch {
 public:
  void Add(std::string_view number);
  // True once commas are known to be decimal.
  bool is_decided() const { return is_decided_; }
  // Number whose comma may part thousands; empty: none.
  const std::string& doubtful() const { return doubtful_; }

 private:
  bool is_decided_ = false;
  std::string doubtful_;
};

// True for a number with separators of lakhs and crores, such as 3,61,725.5:
// three digits in the last group and two in those before it.
bool IsLakhNumber(std::string_view cell);

// Returns the sentence that refuses such a number.
std::string WhyNoLakh(std::string_view cell);

// Returns the sentence that refuses a number whose `decimal` may part
// thousands. Its advice holds where no format can be given, too: one number
// that is written in another way decides.
std::string WhyDoubtful(std::string_view number, char decimal);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_THOUSANDS_H_
