// Entries of a JSON file as a table.

#ifndef PINODE_CASE_TEXT_JSON_TABLE_H_
#define PINODE_CASE_TEXT_JSON_TABLE_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pinode {

// Returns a CSV text with a line for each of `entries` (an array, not empty, of
// objects that have the same keys) under their keys. It writes texts, numbers,
// 1 and 0 for true and false, and lists of texts with blanks between. Null and
// numbers that are not finite are empty.
std::string TableOfEntries(const nlohmann::ordered_json& entries);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_JSON_TABLE_H_
