// What the readers of matrix files in text share: lines with their numbers,
// words, and messages about both. Not meant for other floors.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// The lines of a text, without blanks around them. Keeps `path` and the text by
// reference.
class LineReader {
 public:
  LineReader(const std::string& path, std::string_view text);

  // The next line of any kind; false behind the last one.
  bool Next(std::string_view* line);
  // As Next, with its blanks: for formats that go by columns.
  bool NextRaw(std::string_view* line);
  // The next line that is neither blank nor a comment.
  bool NextContent(char comment, std::string_view* line);

  // Line number of the last line read, from 1.
  int number() const { return number_; }

  // "path:line" of the last line read.
  std::string Place() const;

  // Sets *error to a message about the last line read; returns false.
  bool Fail(const std::string& message, std::string* error) const;
  // The same about another line.
  bool FailAt(int line, const std::string& message, std::string* error) const;

 private:
  const std::string& path_;
  std::string_view rest_;
  int number_ = 0;
};

// "(row, column)" counted from 1, as files do; arguments count from 0.
std::string EntryText(Eigen::Index row, Eigen::Index column);

// "rows x columns".
std::string SizeText(Eigen::Index rows, Eigen::Index columns);

// The words of a line; runs of blanks separate them.
std::vector<std::string_view> SplitBlanks(std::string_view line);

// Parses one matrix entry; false with *error set if it is no finite number.
bool ParseEntry(const LineReader& lines, std::string_view text,
                Eigen::Index row, Eigen::Index column, double* value,
                std::string* error);

// One entry as a file gives it; indices from 0.
struct MatrixEntry {
  int row = 0;
  int column = 0;
  double value = 0.0;
  // Of the file, from 1; 0 in formats without lines.
  int line = 0;
  // Added as the mirror image of what the file has.
  bool mirror = false;
};

// The matrix of these entries, each of which must lie inside (CHECKed).
// `mirrored`: entries off the diagonal stand for two. Zeros that the file
// states are kept: they belong to the sparsity that the user sees again. False,
// with the later one in *duplicate, if a place is given twice (with `mirrored`,
// also by its mirror image). Reorders the entries.
bool AssembleMatrix(int rows, int columns, bool mirrored,
                    std::vector<MatrixEntry>* entries, SparseMatrix* matrix,
                    MatrixEntry* duplicate);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_
