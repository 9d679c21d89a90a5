#include "pinode/watch/mending.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/watch/watch.h"

namespace pinode {
namespace {

constexpr char kForms[] =
    "expected reject:FILE, accept:FILE, name:HZ=NAME or acknowledge:TIME";

bool ParseName(const std::string& text, StoredMend* mend, std::string* error) {
  const size_t equal = text.find('=');
  double hz = 0.0;
  if (equal == std::string::npos || equal + 1 == text.size() ||
      !ParseDouble(text.substr(0, equal), &hz) || !(hz > 0.0)) {
    *error = "--mend=name:" + text +
             ": expected a frequency in Hz and a name, such as "
             "name:13.2=torsion";
    return false;
  }
  mend->subject = FormatNumber(hz);
  mend->value = text.substr(equal + 1);
  return true;
}

// Finds the content of the record with a file name.
bool FindRecord(const std::string& name, int64_t structure, Store* store,
                std::string* content, std::string* error) {
  std::vector<StoredRecord> records;
  if (!store->Records(structure, &records, error)) return false;
  int count = 0;
  for (const StoredRecord& record : records) {
    if (record.name != name) continue;
    *content = record.content;
    ++count;
  }
  if (count == 1) return true;
  *error = count == 0 ? "no record in the store has the name '" + name +
                            "'; use the name of the file, without its folder"
                      : std::to_string(count) +
                            " records in the store have the "
                            "name '" +
                            name +
                            "'; rename the files, and fill a new "
                            "store by --backfill";
  return false;
}

// Finds the time in s of the alarm with a printed time.
bool FindAlarm(const std::string& text, int64_t structure, Store* store,
               std::string* time, std::string* error) {
  std::vector<StoredEvent> events;
  if (!store->Events(structure, &events, error)) return false;
  std::vector<std::string> alarms;
  for (const StoredEvent& event : events) {
    if (event.kind != "alarm") continue;
    alarms.push_back(DateText(event.time));
    if (alarms.back() != text) continue;
    *time = FormatNumber(event.time, 17);
    return true;
  }
  *error = "no alarm of '" + text + "' is in the store; " +
           (alarms.empty() ? std::string("it has none")
                           : "the last one is of " + alarms.back());
  return false;
}

}  // namespace

bool ParseDecision(const std::string& text, const std::string& person,
                   const std::string& reason, StoredMend* mend,
                   std::string* error) {
  if (person.empty() || reason.empty()) {
    *error = "--mend needs --by=PERSON and --why=REASON, which are stored too";
    return false;
  }
  mend->person = person;
  mend->reason = reason;
  const size_t colon = text.find(':');
  mend->kind = text.substr(0, colon);
  mend->value = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (!mend->value.empty()) {
    if (mend->kind == "name") return ParseName(mend->value, mend, error);
    if (mend->kind == "reject" || mend->kind == "accept" ||
        mend->kind == "acknowledge") {
      return true;
    }
  }
  *error = "--mend=" + text + ": " + kForms;
  return false;
}

bool Mend(StoredMend mend, int64_t structure, Store* store,
          std::string* message, std::string* error) {
  if (mend.kind == "name") {
    *message = "mode at " + mend.subject + " Hz: named " + mend.value;
  } else if (mend.kind == "acknowledge") {
    *message = "alarm of " + mend.value + ": acknowledged";
    if (!FindAlarm(mend.value, structure, store, &mend.subject, error)) {
      return false;
    }
  } else {
    *message = "record " + mend.value + ": " + mend.kind + "ed";
    if (!FindRecord(mend.value, structure, store, &mend.subject, error)) {
      return false;
    }
  }
  return store->AddMend(structure, mend, error);
}

int LeaveOutRejected(const std::vector<StoredMend>& mends,
                     std::vector<StoredRecord>* records) {
  std::map<std::string, bool> is_rejected;
  for (const StoredMend& mend : mends) {
    if (mend.kind == "reject") is_rejected[mend.subject] = true;
    if (mend.kind == "accept") is_rejected[mend.subject] = false;
  }
  const auto begin = std::remove_if(
      records->begin(), records->end(), [&](const StoredRecord& record) {
        const auto found = is_rejected.find(record.content);
        return found != is_rejected.end() && found->second;
      });
  const int count = static_cast<int>(records->end() - begin);
  records->erase(begin, records->end());
  return count;
}

std::vector<std::pair<double, std::string>> NamesOfModes(
    const std::vector<StoredMend>& mends) {
  std::vector<std::pair<double, std::string>> names;
  for (const StoredMend& mend : mends) {
    double hz = 0.0;
    if (mend.kind != "name" || !ParseDouble(mend.subject, &hz)) continue;
    names.emplace_back(hz, mend.value);
  }
  return names;
}

std::string DecisionText(const StoredMend& mend) {
  return mend.kind + " " +
         (mend.kind == "name" ? mend.subject + " Hz: " : std::string()) +
         mend.value;
}

std::string Acknowledgement(const std::vector<StoredMend>& mends,
                            const StoredEvent& event) {
  std::string text;
  for (const StoredMend& mend : mends) {
    double time = 0.0;
    if (mend.kind != "acknowledge" || event.kind != "alarm" ||
        !ParseDouble(mend.subject, &time) ||
        std::abs(time - event.time) > 1e-3) {
      continue;
    }
    text = mend.person + ", " + DateText(mend.time) + ": " + mend.reason;
  }
  return text;
}

}  // namespace pinode
