#include "pinode/base/logging.h"
#include "pinode/structure/model/model.h"
  #  include "pinode/record/record.h"  // refused
#include <pinode/base/logging.h>       // refused
#include "model.h"                     // refused
#include "../record/record.h"          // refused
#include "record/record.h"             // refused
#include <toml++/toml.h>               // refused
