// Entries of a JSON file as a table, for those who read tables.

#ifndef PINODE_CASE_TEXT_JSON_TABLE_H_
#define PINODE_CASE_TEXT_JSON_TABLE_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pinode {

// A CSV text with a line for each of `entries` (an array, not empty, of objects
// that have the same keys) under their keys: texts, numbers, 1 and 0 for true
// and false, lists of texts with blanks between; nothing for null and for
// numbers that are not finite.
std::string TableOfEntries(const nlohmann::ordered_json& entries);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_JSON_TABLE_H_
