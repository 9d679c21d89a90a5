#include "pinode/estimate/fit/fit.h"       // refused
#include "pinode/estimate/no_room/fit.h"   // refused
#include "pinode/estimate/solver/solve.h"
#include "tests/support/kit.h"             // refused
