// Writes MATLAB files, version 5 with compressed variables, by matio; MATLAB
// from 7 on, Octave and SciPy read them.

#ifndef PINODE_BASE_ARRAYS_MATLAB_WRITER_H_
#define PINODE_BASE_ARRAYS_MATLAB_WRITER_H_

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A field of a structure: a column of numbers, or of texts.
struct MatlabField {
  std::string name;
  Vector numbers;
  std::vector<std::string> texts;  // where these are there, a cell array
};

// Names are made valid (letters, digits and '_', a letter first, at most 63),
// and different from those that are there. Any Add after a failure does
// nothing; Close, which writes the file, says what went wrong.
class MatlabWriter {
 public:
  explicit MatlabWriter(const std::string& path);
  ~MatlabWriter();
  MatlabWriter(const MatlabWriter&) = delete;
  MatlabWriter& operator=(const MatlabWriter&) = delete;

  void AddMatrix(const std::string& name, const Matrix& matrix);
  // As MATLAB's sparse.
  void AddSparse(const std::string& name,
                 const Eigen::SparseMatrix<double>& matrix);
  // UTF-8.
  void AddText(const std::string& name, const std::string& text);
  // A structure of columns, one below the other.
  void AddStructure(const std::string& name,
                    const std::vector<MatlabField>& fields);
  // The whole file, or, with one line in *error, none; what was there before
  // then stays.
  [[nodiscard]] bool Close(std::string* error);

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
};

// Whether a variable of so many bytes is one of a file of version 5, where
// sizes are numbers of 31 bits.
bool FitsMatlabFile(Eigen::Index bytes);

// `name` as MATLAB takes it, and none of `taken`, to which it is added.
std::string MatlabName(const std::string& name,
                       std::vector<std::string>* taken);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MATLAB_WRITER_H_
