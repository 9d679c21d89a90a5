// Flags for the form of text files and the factors of columns, named as the
// keys of a record and its channels that they stand for. For programs that read
// a data file without a case.

#ifndef PINODE_APPS_TEXT_FLAGS_H_
#define PINODE_APPS_TEXT_FLAGS_H_

#include <string>
#include <vector>

#include "pinode/record/column_scales.h"
#include "pinode/record/files/text_format.h"

namespace pinode {

// Names of the flags, without dashes.
std::vector<const char*> TextFlagNames();

// Reads the flags. What is not given stays to be found from the text. On a bad
// value returns false, with one line in *error that names the flag.
[[nodiscard]] bool ReadTextFlags(TextFormat* format, std::string* error);

// Reads --scale, likewise.
[[nodiscard]] bool ReadScaleFlag(ColumnScales* scales, std::string* error);

}  // namespace pinode

#endif  // PINODE_APPS_TEXT_FLAGS_H_
