#include <toml++/toml.h>

#include "pinode/damage/verdict.h"
#include "pinode/estimate/problem.h"
#include "pinode/report/figure.h"  // refused
#include <gflags/gflags.h>         // refused
#include <pybind11/pybind11.h>     // refused
