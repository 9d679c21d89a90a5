// Sentences on a text file: what was assumed of it, and why a row is not read.

#ifndef PINODE_RECORD_FILES_TEXT_SENTENCES_H_
#define PINODE_RECORD_FILES_TEXT_SENTENCES_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pinode/record/files/text_layout.h"

namespace pinode {

// Returns what was found of a layout, as a list of phrases.
std::string DescribeLayout(const TextLayout& layout);

// Returns why a cell is no number with this decimal sign, and the key that
// helps. `is_time`: the cell is one of the time. `is_text`: the whole column of
// the time is text.
std::string WhyNoNumber(std::string_view cell, char decimal, bool is_time,
                        bool is_text);

// Returns why lines of `num_cells` numbers below `line` are no rows of
// channels: PEER and ObsPy wrap the samples of one motion. `first_row` is the
// number of the first of them. Empty: they may be rows.
std::string WhyWrapped(std::string_view line, size_t num_cells,
                       int64_t first_row);

// Returns why a row of `num_cells` cells is none of a layout.
std::string WhyRagged(size_t num_cells, const TextLayout& layout);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_SENTENCES_H_
