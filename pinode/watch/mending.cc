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

class Mender {
 public:
  Mender(int64_t structure, Store* store)
      : structure_(structure), store_(*store) {}

  bool Parse(const std::string& text, StoredMend* mend, std::string* message,
             std::string* error) {
    const size_t colon = text.find(':');
    mend->kind = text.substr(0, colon);
    const std::string rest =
        colon == std::string::npos ? "" : text.substr(colon + 1);
    if (rest.empty()) {
      *error = "--mend=" + text + ": " + kForms;
      return false;
    }
    if (mend->kind == "reject" || mend->kind == "accept") {
      *message = "record " + rest + ": " + mend->kind + "ed";
      mend->value = rest;
      return FindRecord(rest, &mend->subject, error);
    }
    if (mend->kind == "name") return ParseName(rest, mend, message, error);
    if (mend->kind == "acknowledge") {
      *message = "alarm of " + rest + ": acknowledged";
      mend->value = rest;
      return FindAlarm(rest, &mend->subject, error);
    }
    *error = "--mend=" + text + ": " + kForms;
    return false;
  }

 private:
  bool FindRecord(const std::string& name, std::string* content,
                  std::string* error) {
    std::vector<StoredRecord> records;
    if (!store_.Records(structure_, &records, error)) return false;
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

  static bool ParseName(const std::string& text, StoredMend* mend,
                        std::string* message, std::string* error) {
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
    *message = "mode at " + mend->subject + " Hz: named " + mend->value;
    return true;
  }

  bool FindAlarm(const std::string& text, std::string* time,
                 std::string* error) {
    std::vector<StoredEvent> events;
    if (!store_.Events(structure_, &events, error)) return false;
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

  int64_t structure_;
  Store& store_;
};

}  // namespace

bool Mend(const std::string& text, const std::string& person,
          const std::string& reason, double now, int64_t structure,
          Store* store, std::string* message, std::string* error) {
  if (person.empty() || reason.empty()) {
    *error = "--mend needs --by=PERSON and --why=REASON, which are stored too";
    return false;
  }
  StoredMend mend;
  mend.time = now;
  mend.person = person;
  mend.reason = reason;
  return Mender(structure, store).Parse(text, &mend, message, error) &&
         store->AddMend(structure, mend, error);
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
