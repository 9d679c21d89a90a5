// Scales that turn the counts of a TDMS channel into physical values.

#ifndef PINODE_RECORD_FILES_LOGGERS_TDMS_SCALES_H_
#define PINODE_RECORD_FILES_LOGGERS_TDMS_SCALES_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/record/files/loggers/tdms_objects.h"

namespace pinode {

// Properties of a channel, and of its group and file where it has none.
class TdmsProperties {
 public:
  void Add(const TdmsObject* object);
  const TdmsProperty* Find(const std::string& name) const;
  // Returns false if there is no such finite number.
  [[nodiscard]] bool Number(const std::string& name, double* number) const;
  // Returns an empty text if there is none.
  std::string Text(const std::string& name) const;

 private:
  std::vector<const TdmsObject*> objects_;
};

// Scales of a channel, as its properties NI_Scale[i]_... state them. The last
// one gives the values. Each takes the numbers of the file, or the values of
// scales before it: polynomials, tables with linear interpolation, sums and
// differences. A scale without a type is a series of DAQmx with its number.
//
// Two conventions are those of National Instruments' own readers, as npTDMS
// found them: a table maps its "scaled" to its "pre-scaled" values, and a
// difference is the right operand minus the left one.
class TdmsScales {
 public:
  // Values of the file, by the number of the scale that takes them.
  using Series = std::map<uint32_t, Vector>;

  // Reads the scales of an object. Returns false with a sentence if one cannot
  // be read, or takes what is not there.
  [[nodiscard]] bool Read(const TdmsObject& object,
                          const TdmsProperties& properties, std::string* fault);

  // Returns the scaled values.
  Vector Apply(Series series) const;

  // Returns true if counts are taken as they are.
  bool empty() const { return scales_.empty(); }

 private:
  enum class Kind { kSeries, kPolynomial, kTable, kSum, kDifference };
  struct Scale {
    Kind kind = Kind::kPolynomial;
    // Scales or series that it takes; two for a sum or a difference.
    std::vector<uint32_t> inputs = {kTdmsRawSeries};
    // Coefficients of a polynomial from the constant one on; values of a table.
    std::vector<double> coefficients;
    std::vector<double> table_inputs;  // increasing
  };

  static bool ReadScale(const TdmsProperties& properties,
                        const std::string& start, Scale* scale);
  static bool ReadPolynomial(const TdmsProperties& properties,
                             const std::string& start, Scale* scale);
  static bool ReadTable(const TdmsProperties& properties,
                        const std::string& start, Scale* scale);
  static bool ReadOperands(const TdmsProperties& properties,
                           const std::string& start, Scale* scale);
  static Vector Evaluate(const Scale& scale,
                         const std::vector<const Vector*>& inputs);

  std::vector<Scale> scales_;
  // Series that counts if there are no scales.
  uint32_t only_series_ = kTdmsRawSeries;
};

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_TDMS_SCALES_H_
