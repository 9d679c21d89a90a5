#include "pinode/dynamics/own_code.h"

#include <cstdlib>

namespace pinode {
namespace {

bool is_refused = false;

}  // namespace

void RefuseOwnCode() { is_refused = true; }

bool IsOwnCodeRefused() {
  const char* variable = std::getenv("PINODE_NO_CODE");
  return is_refused || (variable != nullptr && variable[0] != '\0');
}

}  // namespace pinode
