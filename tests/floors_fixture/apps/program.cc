#include <gflags/gflags.h>

#include "apps/flags.h"
#include "pinode/base/logging.h"
#include "pinode/pinode.h"
#include "pinode/report/figure.h"
#include <glog/logging.h>  // refused
