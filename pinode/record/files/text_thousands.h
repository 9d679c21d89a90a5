// Separators of thousands in the numbers of a text file.

#ifndef PINODE_RECORD_FILES_TEXT_THOUSANDS_H_
#define PINODE_RECORD_FILES_TEXT_THOUSANDS_H_

#include <string>
#include <string_view>
#include <vector>

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

// Returns a number of a run with decimal points that may have its point between
// thousands, or an empty text. In such a column all points stand before the
// last three digits, and other cells are short whole numbers: 12 and 1.250.
// Any number of another form in the rows tells that points are decimal.
std::string DoubtfulThousands(const std::vector<TextLine>& lines,
                              const RowRun& run);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_THOUSANDS_H_
