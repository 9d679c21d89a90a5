// Tables of short texts and numbers, aligned by decimal points.

#ifndef PINODE_REPORT_TEXT_TABLE_H_
#define PINODE_REPORT_TEXT_TABLE_H_

#include <string>
#include <vector>

namespace pinode {

// Returns the number of terminal columns of UTF-8 text, one per code point:
// right for the names and units of structures, not for wide scripts.
int DisplayWidth(const std::string& text);

class TextTable {
 public:
  enum class Align {
    kLeft,
    // Numbers by their decimal points (a number without one: after its last
    // digit); other texts end at the right edge.
    kDecimal,
  };
  struct Column {
    std::string header;
    Align align = Align::kLeft;
  };

  explicit TextTable(std::vector<Column> columns);

  // Adds a row with one cell per column.
  void AddRow(std::vector<std::string> cells);

  bool empty() const { return rows_.empty(); }
  int num_rows() const { return static_cast<int>(rows_.size()); }
  const std::vector<Column>& columns() const { return columns_; }

  // Returns rows of cells. Cells of decimal columns are padded with blanks to
  // the width of the longest, header excluded, so that the points are aligned.
  std::vector<std::vector<std::string>> AlignedRows() const;

  // Returns header, a rule, and the rows, two blanks between columns, each line
  // after `indent` blanks and ended by a line break, without trailing blanks.
  std::string ToText(int indent = 2) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace pinode

#endif  // PINODE_REPORT_TEXT_TABLE_H_
