#include "pinode/case/sections/shared_tables.h"

#include <cstdint>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/record/files/array_table.h"

namespace pinode {
namespace {

// Appends a text after its length.
void AppendText(const std::string& text, std::string* to) {
  *to += std::to_string(text.size()) + ":" + text;
}

std::string TakeText(std::string* from) {
  const size_t colon = from->find(':');
  const size_t size = std::stoull(from->substr(0, colon));
  std::string text = from->substr(colon + 1, size);
  from->erase(0, colon + 1 + size);
  return text;
}

std::string AsText(const std::vector<SharedTables::Wanted>& all) {
  std::string text;
  for (const SharedTables::Wanted& wanted : all) {
    AppendText(wanted.path, &text);
    AppendText(std::to_string(wanted.columns.size()), &text);
    for (const std::string& column : wanted.columns) AppendText(column, &text);
    AppendText(wanted.format.AsText(), &text);
  }
  return text;
}

}  // namespace

SharedTables::SharedTables(Communicator* communicator)
    : communicator_(CommunicatorOrSingle(communicator)) {}

void SharedTables::Plan(std::vector<Wanted> wanted) {
  has_planned_ = true;
  if (communicator_.size() == 1) return;
  // Plan of the first rank, if all ranks have come so far.
  if (!communicator_.AllTrue(true)) return;
  std::string first = AsText(wanted);
  const std::string own = first;
  if (!communicator_.Broadcast(0, &first) ||
      !communicator_.AllTrue(first == own)) {
    return;
  }
  planned_ = std::move(wanted);
  for (size_t i = 0; i < planned_.size(); ++i) {
    if (OwnerOf(i) == communicator_.rank()) own_[i] = ReadFile(planned_[i]);
  }
  if (!communicator_.Await()) planned_.clear();
}

void SharedTables::Finish() {
  if (has_planned_) return;
  has_planned_ = true;
  // The others then read for themselves, and so does this rank: the plan is
  // empty.
  if (!communicator_.AllTrue(false)) planned_.clear();
}

SharedTables::Result SharedTables::ReadFile(const Wanted& wanted) {
  ++num_read_;
  Result result;
  result.ok = ReadTable(wanted.path, wanted.columns, wanted.format,
                        &result.table, &result.error);
  return result;
}

bool SharedTables::Pass(int owner, Result* result) {
  Table& table = result->table;
  std::string head;
  if (owner == communicator_.rank()) {
    AppendText(result->ok ? "read" : "refused", &head);
    AppendText(result->error, &head);
    AppendText(table.path, &head);
    AppendText(std::to_string(table.values.rows()), &head);
    AppendText(std::to_string(table.line_numbers.size()), &head);
    AppendText(table.reading, &head);
    AppendText(table.time_unit, &head);
    AppendText(std::to_string(static_cast<int>(table.time_origin.kind)), &head);
    AppendText(FormatNumber(table.time_origin.seconds, 17), &head);
    AppendText(std::to_string(table.units.size()), &head);
    for (const std::string& unit : table.units) AppendText(unit, &head);
    for (const std::string& column : table.columns) AppendText(column, &head);
  }
  if (!communicator_.Broadcast(owner, &head)) return false;
  if (owner != communicator_.rank()) {
    result->ok = TakeText(&head) == "read";
    result->error = TakeText(&head);
    table.path = TakeText(&head);
    const Eigen::Index rows = std::stoll(TakeText(&head));
    table.line_numbers.resize(std::stoull(TakeText(&head)));
    table.reading = TakeText(&head);
    table.time_unit = TakeText(&head);
    table.time_origin.kind =
        static_cast<TimeOrigin::Kind>(std::stoi(TakeText(&head)));
    table.time_origin.seconds = std::stod(TakeText(&head));
    table.units.resize(std::stoull(TakeText(&head)));
    for (std::string& unit : table.units) unit = TakeText(&head);
    while (!head.empty()) table.columns.push_back(TakeText(&head));
    table.values.resize(rows, static_cast<Eigen::Index>(table.columns.size()));
  }
  const auto pass = [&](auto* numbers, auto count) {
    return count == 0 ||
           communicator_.Broadcast(owner, numbers,
                                   static_cast<int64_t>(count) *
                                       static_cast<int64_t>(sizeof(*numbers)));
  };
  return pass(table.values.data(), table.values.size()) &&
         pass(table.line_numbers.data(), table.line_numbers.size());
}

bool SharedTables::Read(const Wanted& wanted, Table* table,
                        std::string* error) {
  Result result;
  const size_t index = next_;
  if (index >= planned_.size() || !(planned_[index] == wanted)) {
    result = ReadFile(wanted);
  } else {
    ++next_;
    const auto own = own_.find(index);
    if (own != own_.end()) {
      result = std::move(own->second);
      own_.erase(own);
    }
    if (!Pass(OwnerOf(index), &result)) {
      *error = wanted.path + ": the rank that reads it does not answer";
      return false;
    }
  }
  if (result.ok) {
    *table = std::move(result.table);
  } else {
    *error = std::move(result.error);
  }
  return result.ok;
}

}  // namespace pinode
