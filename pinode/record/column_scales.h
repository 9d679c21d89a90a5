// Factors on the numbers of a file's columns.

#ifndef PINODE_RECORD_COLUMN_SCALES_H_
#define PINODE_RECORD_COLUMN_SCALES_H_

#include <map>
#include <string>
#include <vector>

namespace pinode {

// Factors as the key `scale` of a channel has them: number of the file times
// factor is in the unit of the channel. One for all columns, or one each.
class ColumnScales {
 public:
  // Reads "0.001" for all columns, or "acc_1=0.001,acc_2=2" for some. An empty
  // text is no factor. Fails with a sentence for anything else, and for factors
  // that are 0 or not finite.
  [[nodiscard]] bool Parse(const std::string& text, std::string* error);

  // Sets the factors: one of all columns, and those of some by name. Fails like
  // Parse().
  [[nodiscard]] bool Set(double of_all,
                         const std::map<std::string, double>& by_column,
                         std::string* error);

  // Returns the factor of a column, which may be named with and without the
  // unit behind its name; 1 without one.
  double FactorOf(const std::string& name,
                  const std::string& short_name = "") const;

  // Finds factors of columns that are none of `known`. Fails with a sentence on
  // the first one.
  [[nodiscard]] bool AreOf(const std::vector<std::string>& known,
                           std::string* error) const;

 private:
  double of_all_ = 1.0;
  std::map<std::string, double> by_column_;
};

}  // namespace pinode

#endif  // PINODE_RECORD_COLUMN_SCALES_H_
