#include "pinode/base/free_memory.h"

#if defined(__linux__)
#include <malloc.h>
#endif

namespace pinode {

void ReturnFreeMemory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace pinode
