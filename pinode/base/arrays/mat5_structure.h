// Whether a MATLAB 5 file is whole. matio does not say when data end before
// their announced length and hands out what its buffers held before, so its
// numbers are only read from files that pass this.

#ifndef PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_
#define PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_

#include <string>

namespace pinode {

// Walks the data elements of `content`, a file of version 5 ("MAT-File
// Format", The MathWorks): elements fill the file, parts fill elements,
// compressed ones unpack with the right checksum, and numeric arrays have as
// many numbers as their dimensions say. False with a sentence in *what.
bool IsWholeMat5(const std::string& content, std::string* what);

// Whether the file begins as one of version 5 does (7.3 is HDF5).
bool IsMat5(const std::string& content);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MAT5_STRUCTURE_H_
