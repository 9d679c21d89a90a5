// Files of a record, and their contents on the record's own grid.

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

// Reads the files of a record. A record's grid is that of its file or, without
// a file, of its rate and duration. Other files have grids of their own. Their
// contents are put onto the record's grid, NaN where they do not reach. Each
// change of a signal is reported by a remark.
class RecordFiles {
 public:
  // Keeps references to all arguments, which must outlive the object.
  RecordFiles(const RecordSection& section, const UnitSystem& units,
              std::vector<std::string>* remarks)
      : section_(section),
        table_(section.table),
        units_(units),
        remarks_(*remarks) {}

  // Returns the tables of files that Read needs, in that order.
  static std::vector<SharedTables::Wanted> TablesOf(
      const RecordSection& section, bool simulation);

  // Reads all signals of the section; in a simulation no responses.
  [[nodiscard]] bool Read(bool simulation);

  // Grid of the record, in model time.
  double start_time() const { return start_time_; }
  double step() const { return step_; }
  Eigen::Index num_samples() const { return num_samples_; }
  // Unit of the file's times: that of the case, or of the file itself. Model
  // time is time_factor * file time.
  const std::string& time_unit() const { return time_unit_; }
  double time_factor() const { return time_factor_; }

  // Returns the column of `signal` in model units, with its sign and scale, and
  // without its mean on request. Readings of a covariate are joined by straight
  // lines. Completeness of an input is not checked here, because only the
  // window matters.
  [[nodiscard]] bool Signal(const SignalSection& signal, bool is_input,
                            bool is_covariate, Channel* channel);

  // Mean of a signal by its label, model units; 0: no mean was subtracted.
  double SubtractedMean(const std::string& label) const;

  // Frees the file contents.
  void Clear() { files_.clear(); }

 private:
  // One file on its own grid.
  struct Source {
    double start_time = 0.0;
    double step = 0.0;
    Eigen::Index num_samples = 0;
    Vector motion;  // of an AT2
    Table table;    // of any other file
    // Table in memory, if all of it is used: that of the case's data, which
    // outlives this object.
    const Table* array = nullptr;
    TimeGrid grid;
    std::string time_unit;
    double time_factor = 1.0;

    const Table& columns() const { return array != nullptr ? *array : table; }

    // Returns a column unchanged.
    Vector Column(const std::string& name) const;
  };

  bool SetGrid();
  bool ReadFile(const std::string& path,
                const std::vector<std::string>& columns);
  bool ReadMotion(const std::string& path, Source* file);
  bool ReadColumns(const std::string& path,
                   const std::vector<std::string>& columns, Source* file);
  // Says where the file and the case differ on the unit of a signal.
  void CompareUnits(const SignalSection& signal, const Table& table);
  [[nodiscard]] bool AlignClocks(const SignalSection& signal,
                                 const Source& file, double* later);
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
  std::string time_unit_;
  double time_factor_ = 1.0;
};

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_RECORD_FILES_H_
