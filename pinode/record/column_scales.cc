#include "pinode/record/column_scales.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

bool IsFactor(double value) { return std::isfinite(value) && value != 0.0; }

}  // namespace

bool ColumnScales::Parse(const std::string& text, std::string* error) {
  CHECK(error != nullptr);
  *this = ColumnScales();
  if (StripBlanks(text).empty() ||
      (ParseDouble(text, &of_all_) && IsFactor(of_all_))) {
    return true;
  }
  of_all_ = 1.0;
  for (const std::string_view part : Split(text, ',')) {
    const size_t equals = part.rfind('=');
    double factor = 0.0;
    const bool is_pair = equals != std::string_view::npos;
    const std::string name(is_pair ? StripBlanks(part.substr(0, equals))
                                   : std::string_view());
    if (name.empty() || !ParseDouble(part.substr(equals + 1), &factor) ||
        !IsFactor(factor)) {
      *error = Quote(part) +
               ", expected one factor for all columns, such as 0.001, or "
               "COLUMN=FACTOR,..., each finite and not 0";
      return false;
    }
    if (!by_column_.emplace(name, factor).second) {
      *error = Quote(name) + " is named twice";
      return false;
    }
  }
  return true;
}

bool ColumnScales::Set(double of_all,
                       const std::map<std::string, double>& by_column,
                       std::string* error) {
  std::vector<double> factors = {of_all};
  for (const auto& [name, factor] : by_column) factors.push_back(factor);
  if (!std::all_of(factors.begin(), factors.end(), IsFactor)) {
    *error = "a factor is 0 or not finite, expected another number";
    return false;
  }
  of_all_ = of_all;
  by_column_ = by_column;
  return true;
}

double ColumnScales::FactorOf(const std::string& name,
                              const std::string& short_name) const {
  auto found = by_column_.find(name);
  if (found == by_column_.end()) found = by_column_.find(short_name);
  return found == by_column_.end() ? of_all_ : found->second;
}

bool ColumnScales::AreOf(const std::vector<std::string>& known,
                         std::string* error) const {
  for (const auto& [name, factor] : by_column_) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    *error = "no channel " + Quote(name) + NameHint(name, known);
    return false;
  }
  return true;
}

}  // namespace pinode
