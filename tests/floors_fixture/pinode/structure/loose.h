#include "pinode/structure/model/model.h"  // refused
