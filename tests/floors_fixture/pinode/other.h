// refused
#include "pinode/base/logging.h"
