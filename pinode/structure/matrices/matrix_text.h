// Functions shared by the readers of matrix files in text: lines with their
// numbers, words, and messages about both. Not meant for other layers.

#ifndef PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_
#define PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {

// Iterates over the lines of a text, without blanks around them. Keeps `path`
// and the text by reference.
class LineReader {
 public:
  LineReader(const std::string& path, std::string_view text);

  // Reads the next line of any kind. Returns false after the last one.
  bool Next(std::string_view* line);
  // Does what Next does, but keeps the blanks: for formats with fixed columns.
  bool NextRaw(std::string_view* line);
  // Reads the next line that is neither blank nor a comment.
  bool NextContent(char comment, std::string_view* line);

  // Number of the last line read, from 1.
  int number() const { return number_; }

  // Returns "path:line" of the last line read.
  std::string Place() const;

  // Sets *error to a message about the last line read; returns false.
  bool Fail(const std::string& message, std::string* error) const;
  // Does the same for another line.
  bool FailAt(int line, const std::string& message, std::string* error) const;

 private:
  const std::string& path_;
  std::string_view rest_;
  int number_ = 0;
};

// Returns "(row, column)" counted from 1, as in files. The arguments count from
// 0.
std::string EntryText(Eigen::Index row, Eigen::Index column);

// Returns "rows x columns".
std::string SizeText(Eigen::Index rows, Eigen::Index columns);

// Returns the words of a line. Runs of blanks separate them.
std::vector<std::string_view> SplitBlanks(std::string_view line);

// Parses one matrix entry. Returns false and sets *error if it is not a finite
// number.
bool ParseEntry(const LineReader& lines, std::string_view text,
                Eigen::Index row, Eigen::Index column, double* value,
                std::string* error);

// One entry as in a file. Indices count from 0.
struct MatrixEntry {
  int row = 0;
  int column = 0;
  double value = 0.0;
  // Line of the file, from 1. 0 for formats without lines.
  int line = 0;
  // True if the entry was added as the mirror image of an entry in the file.
  bool mirror = false;
};

// Assembles the matrix from its entries. Each entry must lie inside (CHECKed).
// With `mirrored`, each entry off the diagonal also stands for its mirror
// image. Explicit zeros of the file are kept, because they belong to the
// sparsity that the user sees again. Returns false, with the later entry in
// *duplicate, if a place is given twice (with `mirrored`, also by its mirror
// image). Reorders the entries.
bool AssembleMatrix(int rows, int columns, bool mirrored,
                    std::vector<MatrixEntry>* entries, SparseMatrix* matrix,
                    MatrixEntry* duplicate);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_MATRIX_TEXT_H_
