// Decisions of people about records, modes and alarms.

#ifndef PINODE_WATCH_MENDING_H_
#define PINODE_WATCH_MENDING_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// Parses a decision:
//
//   reject:FILE          the record is left out of the analysis
//   accept:FILE          takes that back
//   name:HZ=NAME         name of the mode with this frequency
//   acknowledge:TIME     somebody has seen the alarm of this time
//
// FILE is the name under which the record was stored. Refuses, with one line,
// another form, and a decision without a person or a reason. The time stays.
[[nodiscard]] bool ParseDecision(const std::string& text,
                                 const std::string& person,
                                 const std::string& reason, StoredMend* mend,
                                 std::string* error);

// Finds the record or the alarm of a parsed decision, and stores the decision.
// Refuses, with one line, a subject that is not in the store. *message tells
// what was stored.
[[nodiscard]] bool Mend(StoredMend mend, int64_t structure, Store* store,
                        std::string* message, std::string* error);

// Removes the rejected records and returns their number.
int LeaveOutRejected(const std::vector<StoredMend>& mends,
                     std::vector<StoredRecord>* records);

// Returns the names of modes with their frequencies in Hz, the oldest first.
// The last name of a mode counts.
std::vector<std::pair<double, std::string>> NamesOfModes(
    const std::vector<StoredMend>& mends);

// Returns a decision as a person would write it, such as "reject a.csv".
std::string DecisionText(const StoredMend& mend);

// Returns who acknowledged an alarm, when and why; empty: nobody has.
std::string Acknowledgement(const std::vector<StoredMend>& mends,
                            const StoredEvent& event);

}  // namespace pinode

#endif  // PINODE_WATCH_MENDING_H_
