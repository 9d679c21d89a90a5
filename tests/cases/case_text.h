// Case files with parts left out or replaced.

#ifndef PINODE_TESTS_CASES_CASE_TEXT_H_
#define PINODE_TESTS_CASES_CASE_TEXT_H_

#include <cstdint>
#include <string>

#include "pinode/case/sections/case_file.h"

namespace pinode {
namespace testing {

// The text of a case file, its path relative to the project's root, in which
// the tables that it names (CSV and Matrix Market) have absolute paths. `data`
// stands for a folder "data/" in these, where it is not empty.
std::string CaseText(const std::string& path, const std::string& data = "");

// The text with all tables [[name]] replaced by one text, where the first was;
// tables of tables of theirs included.
std::string WithTables(const std::string& text, const std::string& name,
                       const std::string& replacement);

// The case of a text. What cannot be read fails the test.
Case CaseOfText(const std::string& text);

// White noise on every fitted channel of the training records, a share of its
// standard deviation.
void AddNoise(double share, uint64_t seed, Case* c);

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_CASE_TEXT_H_
