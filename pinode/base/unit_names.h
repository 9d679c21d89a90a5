// Units as loggers and people write them.

#ifndef PINODE_BASE_UNIT_NAMES_H_
#define PINODE_BASE_UNIT_NAMES_H_

#include <string>
#include <string_view>

#include "pinode/base/units.h"

namespace pinode {

// Returns the name in the table of units (KnownUnits) of what `text` means:
// "mm/s2", "mm/s²" and "mm/sec^2" are "mm/s^2", "Sec" is "s", "Gal" is "gal",
// "µm/m" is "um/m". Empty if no unit is meant, or one that is not in the table.
std::string CanonicalUnit(std::string_view text);

// Finds the dimension of a unit by its name in the table; false if it is not
// there.
[[nodiscard]] bool FindDimension(const std::string& unit, Dimension* dimension);

// Splits a column's name such as "acc [mg]", "acc (mg)", "a / (m/s^2)" or
// "t in s" into the name and the unit as CanonicalUnit() returns it. *unit is
// empty, and *name the whole text, if there is no known unit behind the name.
void SplitUnitOfName(std::string_view text, std::string* name,
                     std::string* unit);

}  // namespace pinode

#endif  // PINODE_BASE_UNIT_NAMES_H_
