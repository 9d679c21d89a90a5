// Memory that is free, back to the system.

#ifndef PINODE_BASE_FREE_MEMORY_H_
#define PINODE_BASE_FREE_MEMORY_H_

namespace pinode {

// Gives back what has been freed, and what the allocator keeps for later:
// between parts of a program that each need about a record's size. Does nothing
// where the C library has no way to.
void ReturnFreeMemory();

}  // namespace pinode

#endif  // PINODE_BASE_FREE_MEMORY_H_
