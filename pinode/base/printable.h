// Text from files, made fit for a terminal.

#ifndef PINODE_BASE_PRINTABLE_H_
#define PINODE_BASE_PRINTABLE_H_

#include <string>
#include <string_view>

namespace pinode {

// Returns `text` with everything escaped that a terminal acts upon or that
// hides or reorders what stands around it: control characters (\x1B), marks of
// the writing direction and characters without a width (\u{202E}), bytes that
// are not UTF-8 (\xFF). Line ends and tabs stay. Words of more than 300
// bytes are clipped: "aaaa...(9750 more)...aaaa".
std::string Printable(std::string_view text);

// Returns the same as one line: line ends and tabs are escaped too (\n), and
// what is longer than 4000 bytes is clipped in its middle.
std::string PrintableLine(std::string_view text);

// Returns at most `width` characters of `text`; "..." takes the place of the
// rest.
std::string Clipped(const std::string& text, size_t width);

}  // namespace pinode

#endif  // PINODE_BASE_PRINTABLE_H_
