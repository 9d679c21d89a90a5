#include "pinode/estimate/solver/solve.h"
