#include <ceres/ceres.h>

#include "pinode/network/network.h"
#include "pinode/record/record.h"
#include "pinode/structure/model/model.h"
#include "pinode/discover/library.h"  // refused
#include "pinode/no_such_floor/a.h"   // refused
#include "pinode/pinode.h"            // refused
#include "apps/flags.h"               // refused
