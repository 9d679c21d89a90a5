// Settings for freed memory, valid for the whole program.

#ifndef PINODE_BASE_FREE_MEMORY_H_
#define PINODE_BASE_FREE_MEMORY_H_

namespace pinode {

// Returns freed memory, and memory that the allocator keeps, to the system.
// From then on, a freed block larger than one megabyte is returned at once. Use
// it between parts of a program that each take about the size of a record.
void ReturnFreedMemory();

// Keeps most of the freed memory for reuse from now on. A network allocates and
// frees matrices of some megabytes in every iteration. Not requesting their
// pages again saves a tenth of its time.
void KeepFreedMemory();

// Both functions do nothing if the C library does not support them.

}  // namespace pinode

#endif  // PINODE_BASE_FREE_MEMORY_H_
