// What becomes of memory that is freed, in a whole program.

#ifndef PINODE_BASE_FREE_MEMORY_H_
#define PINODE_BASE_FREE_MEMORY_H_

namespace pinode {

// Gives back what has been freed, and what the allocator keeps for later; what
// is larger than a megabyte goes back as soon as it is freed from now on: for
// parts of a program that each take about a record's size.
void ReturnFreedMemory();

// From now on most of what is freed is kept: matrices of some megabytes come
// and go with every iteration, and that their pages need not be asked for again
// is a tenth of a network's time.
void KeepFreedMemory();

// Both do nothing where the C library has no way to.

}  // namespace pinode

#endif  // PINODE_BASE_FREE_MEMORY_H_
