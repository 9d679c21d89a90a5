// What readers of foreign files share: words of them, and messages about them.

#ifndef PINODE_BASE_FILE_TEXT_H_
#define PINODE_BASE_FILE_TEXT_H_

#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// ASCII letters; other bytes are left as they are.
std::string LowerCase(std::string_view text);

// For messages: what the file says, in quotes, without control characters and
// not too long.
std::string Quote(std::string_view text);

// The fields of a line between separators, without blanks around them: possibly
// empty.
std::vector<std::string_view> Split(std::string_view line, char separator);

}  // namespace pinode

#endif  // PINODE_BASE_FILE_TEXT_H_
