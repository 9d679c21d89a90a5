#include <vector>

#include "pinode/base/logging.h"
#include "pinode/structure/model/model.h"  // refused
#include <glog/logging.h>            // refused
