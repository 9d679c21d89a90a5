#include "apps/launcher.h"

#include <cstdlib>

#include "pinode/base/strings.h"

namespace pinode {

int NumLaunchedRanks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_SIZE"}) {
    int size = 1;
    const char* value = std::getenv(name);
    if (value != nullptr && ParseInt(value, &size) && size > 1) return size;
  }
  return 1;
}

}  // namespace pinode
