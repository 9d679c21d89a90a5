// Text of universal files: lines, and numbers in columns.

#ifndef PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_
#define PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Iterates over the lines of a text, and the bytes between them.
class UniversalLines {
 public:
  explicit UniversalLines(std::string_view bytes) : rest_(bytes) {}

  bool AtEnd() const { return rest_.empty(); }
  // Returns the next line without its line break. Empty at the end.
  std::string_view Next();
  std::string_view Peek() const;
  // Returns true if a data set, or the text, ends at the next line.
  bool AtEndOfSet() const;
  std::string_view Bytes(size_t count);
  // Returns the text behind the next `skip` bytes.
  UniversalLines Behind(size_t skip) const;
  size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

// Returns true if a line begins or ends a data set: "    -1".
bool IsUniversalSeparator(std::string_view line);

// Returns `width` columns of a line from column `begin`, without blanks around
// them.
std::string_view UniversalField(std::string_view line, size_t begin,
                                size_t width);
// Returns the same as a text. "NONE" means an empty text.
std::string UniversalTextField(std::string_view line, size_t begin,
                               size_t width);
// Parse numbers in columns. Blank means zero.
[[nodiscard]] bool UniversalIntField(std::string_view line, size_t begin,
                                     size_t width, int* value);
[[nodiscard]] bool UniversalRealField(std::string_view line, size_t begin,
                                      size_t width, double* value);

// Appends the numbers of a line. They may touch each other.
[[nodiscard]] bool UniversalNumbers(std::string_view line,
                                    std::vector<double>* values);
[[nodiscard]] bool UniversalIntegers(std::string_view line,
                                     std::vector<int>* values);
[[nodiscard]] bool UniversalInteger(double number, int* value);

// Returns a number in `width` columns, the first of them blank, so that readers
// by columns and readers by blanks understand it. Of forms like "1.2345e-5" and
// "0.000012345" it uses the more accurate one. It always writes a decimal
// point, because Fortran would read 1 as 0.00001. With 13 columns, -1.2345e-100
// has the fewest digits. With 25 columns any number is exact.
std::string UniversalNumber(double value, size_t width);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_UNIVERSAL_TEXT_H_
