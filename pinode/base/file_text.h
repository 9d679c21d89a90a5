// Functions shared by the readers of foreign files: splitting text into words,
// and quoting it in messages.

#ifndef PINODE_BASE_FILE_TEXT_H_
#define PINODE_BASE_FILE_TEXT_H_

#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Returns `text` with ASCII letters in lower case. Other bytes are unchanged.
std::string LowerCase(std::string_view text);

// Returns `text` for a message: in quotes, without control characters, and
// shortened if it is long.
std::string Quote(std::string_view text);

// Returns the fields of a line between separators, without blanks around them.
// Fields may be empty.
std::vector<std::string_view> Split(std::string_view line, char separator);

}  // namespace pinode

#endif  // PINODE_BASE_FILE_TEXT_H_
