// Depth of a TOML text, known before it is parsed.

#ifndef PINODE_CASE_TEXT_TOML_DEPTH_H_
#define PINODE_CASE_TEXT_TOML_DEPTH_H_

#include <string_view>

namespace pinode {

// Deepest nesting that is parsed. Parsers recurse once a level, and so does
// everything that walks through their trees. Case files need 6 levels.
inline constexpr int kDeepestToml = 100;

// Returns the line of the first value that lies deeper than kDeepestToml, or 0
// if there is none. Each part of a dotted key, each array and each inline table
// is a level. The text need not be valid TOML.
int LineOfTooDeepToml(std::string_view text);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_TOML_DEPTH_H_
