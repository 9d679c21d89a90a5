#include "pinode/base/logging.h"
#include "pinode/case/text/read_case.h"
#include "pinode/estimate/problem.h"
#include "pinode/no_such_floor/a.h"  // refused
#include "apps/flags.h"              // refused
