// Writes MATLAB files, version 5 with compressed variables, with matio. MATLAB
// from version 7 on, Octave and SciPy read them.

#ifndef PINODE_BASE_ARRAYS_MATLAB_WRITER_H_
#define PINODE_BASE_ARRAYS_MATLAB_WRITER_H_

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A field of a structure: a column of numbers or of texts.
struct MatlabField {
  std::string name;
  Vector numbers;
  std::vector<std::string> texts;  // if not empty: a cell array
};

// Writes variables to one file. Names are made valid (letters, digits and '_',
// a letter first, at most 63 characters) and unique in the file. An Add after a
// failure does nothing. Close writes the file and reports any failure.
class MatlabWriter {
 public:
  explicit MatlabWriter(const std::string& path);
  ~MatlabWriter();
  MatlabWriter(const MatlabWriter&) = delete;
  MatlabWriter& operator=(const MatlabWriter&) = delete;

  void AddMatrix(const std::string& name, const Matrix& matrix);
  // Adds a sparse matrix, as MATLAB's sparse type.
  void AddSparse(const std::string& name,
                 const Eigen::SparseMatrix<double>& matrix);
  // Adds a text in UTF-8.
  void AddText(const std::string& name, const std::string& text);
  // Adds a structure whose fields are columns.
  void AddStructure(const std::string& name,
                    const std::vector<MatlabField>& fields);
  // Writes the whole file. On failure returns false, with one line in *error,
  // and an existing file stays unchanged.
  [[nodiscard]] bool Close(std::string* error);

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
};

// Returns true if a variable of so many bytes fits into a file of version 5,
// where sizes are numbers of 31 bits.
bool FitsMatlabFile(Eigen::Index bytes);

// Returns `name` made valid for MATLAB and different from all names in `taken`.
// Adds the new name to `taken`.
std::string MatlabName(const std::string& name,
                       std::vector<std::string>* taken);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MATLAB_WRITER_H_
