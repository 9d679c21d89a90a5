// Uses an installed pinode as an engineer's own program would: exits 0 if a
// crossed bound is refused with the parameter's name and a sound block is not.

#include <iostream>
#include <string>

#include "pinode/base/parameter_block.h"

int main() {
  pinode::ParameterBlock block;
  block.name = "springs";
  pinode::Parameter stiffness;
  stiffness.name = "k1";
  stiffness.unit = "N/m";
  stiffness.value = 4e6;
  stiffness.lower = 1e6;
  stiffness.upper = 8e6;
  block.parameters.push_back(stiffness);

  std::string error;
  if (!block.IsValid(&error)) {
    std::cerr << "refused a sound block: " << error << "\n";
    return 1;
  }
  if (block.Values().size() != 1 || block.Values()[0] != 4e6) {
    std::cerr << "the block lost its value\n";
    return 1;
  }
  block.parameters[0].lower = 9e6;
  if (block.IsValid(&error) || error.find("k1") == std::string::npos) {
    std::cerr << "accepted crossed bounds, or did not name k1: " << error
              << "\n";
    return 1;
  }
  return 0;
}
