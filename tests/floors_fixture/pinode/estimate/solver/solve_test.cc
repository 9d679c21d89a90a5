#include "pinode/estimate/fit/fit.h"
#include "tests/support/kit.h"
#include "tests/other/kit.h"  // refused
