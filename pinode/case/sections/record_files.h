// The files that a record names, and what they hold on the record's own grid.

#ifndef PINODE_CASE_SECTIONS_RECORD_FILES_H_
#define PINODE_CASE_SECTIONS_RECORD_FILES_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/case/sections/shared_tables.h"
#include "pinode/record/record.h"
#include "pinode/record/table.h"
#include "pinode/record/time_column.h"

namespace pinode {

// A record's grid is that of its file, or of its rate and duration where it has
// none. Other files have grids of their own; what they hold comes onto that of
// the record, NaN where it does not reach. What is done to a signal is a
// remark.
class RecordFiles {
 public:
  // All of these must outlive the object.
  RecordFiles(const RecordSection& section, const UnitSystem& units,
              std::vector<std::string>* remarks)
      : section_(section),
        table_(section.table),
        units_(units),
        remarks_(*remarks) {}

  // The tables of files that Read wants, in that order.
  static std::vector<SharedTables::Wanted> TablesOf(
      const RecordSection& section, bool simulation);

  // Everything that the section names, but in a simulation no responses.
  [[nodiscard]] bool Read(bool simulation);

  // The grid, in model time.
  double start_time() const { return start_time_; }
  double step() const { return step_; }
  Eigen::Index num_samples() const { return num_samples_; }

  // A column as `signal` wants it: in model units, with its sign and scale,
  // without its mean where that is asked for, readings of a covariate joined by
  // straight lines. Whether an input is complete is not asked here: only the
  // window matters.
  [[nodiscard]] bool Signal(const SignalSection& signal, bool is_input,
                            bool is_covariate, Channel* channel);

  // Of a signal by its label, model units; 0: nothing was subtracted.
  double SubtractedMean(const std::string& label) const;

  // What was read is not needed any more.
  void Clear() { files_.clear(); }

 private:
  // One file on its own grid.
  struct Source {
    double start_time = 0.0;
    double step = 0.0;
    Eigen::Index num_samples = 0;
    Vector motion;  // of an AT2
    Table table;    // of any other file
    // In memory, where all of it is wanted: that of the case's data, which
    // outlives this.
    const Table* array = nullptr;
    TimeGrid grid;

    const Table& columns() const { return array != nullptr ? *array : table; }

    // As it is.
    Vector Column(const std::string& name) const;
  };

  bool SetGrid();
  bool ReadFile(const std::string& path,
                const std::vector<std::string>& columns);
  bool ReadMotion(const std::string& path, Source* file);
  bool ReadColumns(const std::string& path,
                   const std::vector<std::string>& columns, Source* file);
  void FillReadings(const std::string& label, Vector* values);
  bool Align(const SignalSection& signal, const Source& file, bool is_input,
             Vector* values);

  const RecordSection& section_;
  const TomlTable& table_;
  const UnitSystem& units_;
  std::vector<std::string>& remarks_;

  std::map<std::string, double> subtracted_means_;
  std::map<std::string, Source> files_;
  double start_time_ = 0.0;
  double step_ = 0.0;
  Eigen::Index num_samples_ = 0;
};

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_RECORD_FILES_H_
