// Text of universal files: lines, and numbers in columns.

#ifndef PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_
#define PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Lines of a text, and the bytes between them.
class UniversalLines {
 public:
  explicit UniversalLines(std::string_view bytes) : rest_(bytes) {}

  bool AtEnd() const { return rest_.empty(); }
  // Without the line break; empty at the end.
  std::string_view Next();
  std::string_view Peek() const;
  // Whether a data set ends at the next line, or the text does.
  bool AtEndOfSet() const;
  std::string_view Bytes(size_t count);
  // What is left behind the next `skip` bytes.
  UniversalLines Behind(size_t skip) const;
  size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

// Whether a line begins or ends a data set: "    -1".
bool IsUniversalSeparator(std::string_view line);

// Columns `begin` on of a line, stripped.
std::string_view UniversalField(std::string_view line, size_t begin,
                                size_t width);
// The same as a text; "NONE" stands for nothing.
std::string UniversalTextField(std::string_view line, size_t begin,
                               size_t width);
// Numbers in columns; blank means zero.
[[nodiscard]] bool UniversalIntField(std::string_view line, size_t begin,
                                     size_t width, int* value);
[[nodiscard]] bool UniversalRealField(std::string_view line, size_t begin,
                                      size_t width, double* value);

// Appends the numbers of a line, which may touch.
[[nodiscard]] bool UniversalNumbers(std::string_view line,
                                    std::vector<double>* values);
[[nodiscard]] bool UniversalIntegers(std::string_view line,
                                     std::vector<int>* values);
[[nodiscard]] bool UniversalInteger(double number, int* value);

// A number in `width` columns, the first of them blank, for readers by columns
// and by blanks alike: of "1.2345e-5" and "0.000012345" what is nearer, with a
// decimal point always, without which Fortran would read 1 as 0.00001. In 13
// columns -1.2345e-100 has the fewest digits, in 25 any number is exact.
std::string UniversalNumber(double value, size_t width);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_
