#include <benchmark/benchmark.h>

#include "pinode/report/figure.h"
#include "gflags/gflags.h"   // refused
#include "toml++/toml.hpp"  // refused
