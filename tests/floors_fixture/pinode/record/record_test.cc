#include "gtest/gtest.h"
#include "pinode/estimate/problem.h"  // refused
#include "pinode/network/network.h"   // refused
