// Data of an HDF5 file that lie outside of it.

#ifndef PINODE_BASE_ARRAYS_HDF5_STORAGE_H_
#define PINODE_BASE_ARRAYS_HDF5_STORAGE_H_

#include <cstdint>
#include <string>

namespace pinode {

// Returns the reason why the open data set `set` is not read: its samples lie
// in other files (external storage), or are those of other data sets (a virtual
// one, which may even be made of itself). Either would let a file from
// elsewhere read any file of the reader's. Returns "" if the file holds them.
// Ask before any other question: the size of a virtual data set is that of the
// files that it names.
std::string Hdf5StorageFault(std::int64_t set);

// Checks that an HDF5 file that another library reads has no data set with a
// fault, and no link to another file. Fails with the end of a sentence in
// *what.
[[nodiscard]] bool CheckHdf5Storage(const std::string& path, std::string* what);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_HDF5_STORAGE_H_
