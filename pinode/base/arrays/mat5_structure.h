// Checks that a MATLAB 5 file is complete. matio does not report data that end
// before their announced length, and returns old contents of its buffers
// instead. Its numbers are therefore only read from files that pass this check.

#ifndef PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_
#define PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_

#include <string>

namespace pinode {

// Walks the data elements of `content`, a file of version 5 ("MAT-File Format",
// The MathWorks). Elements must fill the file, and parts must fill elements.
// Compressed elements must unpack with the right checksum. Numeric arrays must
// have as many numbers as their dimensions say. Returns false with a sentence
// in *what otherwise.
bool IsWholeMat5(const std::string& content, std::string* what);

// Returns true if the file begins like a file of version 5. Version 7.3 is
// HDF5.
bool IsMat5(const std::string& content);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_
