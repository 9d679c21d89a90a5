// Statements and transactions of a store, for its sources.

#ifndef PINODE_WATCH_STORE_STATEMENT_H_
#define PINODE_WATCH_STORE_STATEMENT_H_

#include <sqlite3.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/watch/store.h"

namespace pinode {

// Prepared statement. Results of its calls are SQLite's codes.
class Store::Statement {
 public:
  Statement(sqlite3* database, const char* sql) {
    code_ = sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& Bind(int64_t value) {
    Keep(sqlite3_bind_int64(statement_, ++place_, value));
    return *this;
  }
  // NaN becomes NULL.
  Statement& Bind(double value) {
    Keep(sqlite3_bind_double(statement_, ++place_, value));
    return *this;
  }
  Statement& Bind(const std::string& text) {
    Keep(sqlite3_bind_text64(statement_, ++place_, text.data(), text.size(),
                             SQLITE_TRANSIENT, SQLITE_UTF8));
    return *this;
  }
  Statement& Bind(const ComplexVector& values) {
    Keep(sqlite3_bind_blob64(
        statement_, ++place_, values.data(),
        static_cast<sqlite3_uint64>(values.size()) * sizeof(values[0]),
        SQLITE_TRANSIENT));
    return *this;
  }

  Statement& Bind(const Vector& values) {
    // An empty vector has no data, which would become NULL.
    static const double nothing = 0.0;
    Keep(sqlite3_bind_blob64(
        statement_, ++place_, values.size() > 0 ? values.data() : &nothing,
        static_cast<sqlite3_uint64>(values.size()) * sizeof(double),
        SQLITE_TRANSIENT));
    return *this;
  }

  // Runs a statement without results, and makes it ready for the next values.
  bool Run() {
    if (code_ == SQLITE_OK) code_ = sqlite3_step(statement_);
    const bool done = code_ == SQLITE_DONE;
    sqlite3_reset(statement_);
    code_ = SQLITE_OK;
    place_ = 0;
    return done;
  }
  // Steps to the next row; false at the end, or at an error.
  bool Step() {
    if (code_ != SQLITE_OK && code_ != SQLITE_ROW) return false;
    code_ = sqlite3_step(statement_);
    return code_ == SQLITE_ROW;
  }
  bool IsAtEnd() const { return code_ == SQLITE_DONE; }

  int64_t Integer(int column) const {
    return sqlite3_column_int64(statement_, column);
  }
  double Number(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL
               ? kNaN
               : sqlite3_column_double(statement_, column);
  }
  std::string Text(int column) const {
    const auto* text =
        reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    const int size = sqlite3_column_bytes(statement_, column);
    return text == nullptr ? std::string()
                           : std::string(text, static_cast<size_t>(size));
  }
  ComplexVector Shape(int column) const {
    const void* data = sqlite3_column_blob(statement_, column);
    const size_t size =
        static_cast<size_t>(sqlite3_column_bytes(statement_, column));
    ComplexVector values(
        static_cast<Eigen::Index>(size / sizeof(std::complex<double>)));
    if (data != nullptr) {
      std::memcpy(
          values.data(), data,
          static_cast<size_t>(values.size()) * sizeof(std::complex<double>));
    }
    return values;
  }

 private:
  void Keep(int code) {
    if (code != SQLITE_OK) code_ = code;
  }

  sqlite3_stmt* statement_ = nullptr;
  int code_ = SQLITE_OK;
  int place_ = 0;
};

// Transaction that is undone unless it is committed.
class Store::Transaction {
 public:
  explicit Transaction(Store* store) : store_(*store) {}
  ~Transaction() {
    if (open_)
      sqlite3_exec(store_.database_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  bool Begin(std::string* error) {
    open_ = store_.Execute("BEGIN IMMEDIATE", error);
    return open_;
  }
  bool Commit(std::string* error) {
    if (!store_.Execute("COMMIT", error)) return false;
    open_ = false;
    return true;
  }

 private:
  Store& store_;
  bool open_ = false;
};

}  // namespace pinode

#endif  // PINODE_WATCH_STORE_STATEMENT_H_
